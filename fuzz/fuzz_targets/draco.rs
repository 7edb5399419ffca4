#![no_main]

use meshlod_fuzz::draco;
use meshlod_io::{Weld, gltf};

libfuzzer_sys::fuzz_target!(init: meshlod_fuzz::plant("draco"), |bytes: &[u8]| {
    let Some(glb) = draco::document(bytes) else { return };
    if let Ok(scene) = gltf::read(&glb, &mut |_| None, Weld::Exact) {
        meshlod_fuzz::accept_scene(&scene);
        let glb = gltf::write_glb(&scene, &[]).expect("what was read can be written");
        gltf::read(&glb, &mut |_| None, Weld::Exact).expect("written glTF can be read");
    }
});
