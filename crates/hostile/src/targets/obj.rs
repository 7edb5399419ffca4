use meshlod_io::{Precision, obj};

use crate::accept::accept_scene;

/// Reads an OBJ that is its own library, and writes it.
pub fn run(bytes: &[u8]) {
    // Any material library it names is the file itself, so that this reader is reached too.
    if let Ok(scene) = obj::read(bytes, &mut |_| Some(bytes.to_vec())) {
        accept_scene(&scene);
        // Smoothing groups come back.
        let mut out = Vec::new();
        if obj::write(&scene, Precision::F64, &mut out, &[]).is_ok()
            && let Ok(back) = obj::read(&out, &mut |_| None)
        {
            let groups = |scene: &meshlod_io::Scene| scene.meshes[0].mesh.face_layers.clone();
            assert_eq!(groups(&back), groups(&scene));
        }
    }
}
