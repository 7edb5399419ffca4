#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("progressive"), |bytes: &[u8]| run("progressive", bytes));
