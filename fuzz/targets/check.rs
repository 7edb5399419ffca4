#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("check"), |bytes: &[u8]| run("check", bytes));
