use meshlod_io::{Weld, gltf};

use crate::accept::accept_scene;
use crate::draco;

/// Reads a document around a Draco stream, and writes it.
pub fn run(bytes: &[u8]) {
    let Some(glb) = draco::document(bytes) else { return };
    if let Ok(scene) = gltf::read(&glb, &mut |_| None, Weld::Exact) {
        accept_scene(&scene);
        let glb = gltf::write_glb(&scene, &[]).expect("what was read can be written");
        gltf::read(&glb, &mut |_| None, Weld::Exact).expect("written glTF can be read");
    }
}
