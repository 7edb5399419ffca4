#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("draco"), |bytes: &[u8]| run("draco", bytes));
