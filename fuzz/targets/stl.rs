#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("stl"), |bytes: &[u8]| run("stl", bytes));
