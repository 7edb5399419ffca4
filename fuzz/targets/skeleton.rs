#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("skeleton"), |bytes: &[u8]| run("skeleton", bytes));
