#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("simplify"), |bytes: &[u8]| run("simplify", bytes));
