#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("ply"), |bytes: &[u8]| run("ply", bytes));
