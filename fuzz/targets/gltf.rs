#![no_main]

use meshlod_hostile::{plant, run};

libfuzzer_sys::fuzz_target!(init: plant("gltf"), |bytes: &[u8]| run("gltf", bytes));
