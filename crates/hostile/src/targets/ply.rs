use meshlod_io::{Precision, ply};

use crate::accept::accept_scene;

/// Reads a PLY that is its own texture, and writes it.
pub fn run(bytes: &[u8]) {
    // Any texture that it names is the file itself.
    let Ok(scene) = ply::read_scene(bytes, &mut |_| Some(bytes.to_vec())) else { return };
    accept_scene(&scene);
    let mut out = Vec::new();
    ply::write_scene(&scene, Precision::F64, &mut out).expect("what was read can be written");
    let again = ply::read_scene(&out, &mut |_| None).expect("what was written can be read");
    accept_scene(&again);
    assert_eq!(scene.meshes[0].mesh.faces.len(), again.meshes[0].mesh.faces.len());
}
