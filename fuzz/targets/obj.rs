#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("obj"), |bytes: &[u8]| run("obj", bytes));
