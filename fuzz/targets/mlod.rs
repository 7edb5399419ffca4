#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("mlod"), |bytes: &[u8]| run("mlod", bytes));
