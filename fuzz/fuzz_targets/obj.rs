#![no_main]

use meshlod_io::{Precision, obj};

libfuzzer_sys::fuzz_target!(init: meshlod_fuzz::plant("obj"), |bytes: &[u8]| {
    // Any material library it names is the file itself, so that this reader is reached too.
    if let Ok(scene) = obj::read(bytes, &mut |_| Some(bytes.to_vec())) {
        meshlod_fuzz::accept_scene(&scene);
        // Smoothing groups come back.
        let mut out = Vec::new();
        if obj::write(&scene, Precision::F64, &mut out, &[]).is_ok()
            && let Ok(back) = obj::read(&out, &mut |_| None)
        {
            let groups = |scene: &meshlod_io::Scene| scene.meshes[0].mesh.face_layers.clone();
            assert_eq!(groups(&back), groups(&scene));
        }
    }
});
