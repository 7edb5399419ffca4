#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("mtl"), |bytes: &[u8]| run("mtl", bytes));
