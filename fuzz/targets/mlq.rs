#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("mlq"), |bytes: &[u8]| run("mlq", bytes));
