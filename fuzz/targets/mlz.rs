#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("mlz"), |bytes: &[u8]| run("mlz", bytes));
