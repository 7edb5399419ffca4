#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("off"), |bytes: &[u8]| run("off", bytes));
