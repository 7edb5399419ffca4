#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("smf"), |bytes: &[u8]| run("smf", bytes));
