#![no_main]

use meshlod_io::{Precision, ply};

libfuzzer_sys::fuzz_target!(init: meshlod_fuzz::plant("ply"), |bytes: &[u8]| {
    // Any texture that it names is the file itself.
    let Ok(scene) = ply::read_scene(bytes, &mut |_| Some(bytes.to_vec())) else { return };
    meshlod_fuzz::accept_scene(&scene);
    let mut out = Vec::new();
    ply::write_scene(&scene, Precision::F64, &mut out).expect("what was read can be written");
    let again = ply::read_scene(&out, &mut |_| None).expect("what was written can be read");
    meshlod_fuzz::accept_scene(&again);
    assert_eq!(scene.meshes[0].mesh.faces.len(), again.meshes[0].mesh.faces.len());
});
