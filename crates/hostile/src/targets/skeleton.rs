use meshlod_io::gltf::{Skeleton, SkeletonImage, write_glb};

use crate::accept::accept_scene;

/// Makes scenes of a skeleton, the document of a scene without its meshes.
pub fn run(bytes: &[u8]) {
    for (meshes, images) in [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1)] {
        for has_animations in [false, true] {
            let skeleton = Skeleton {
                document: bytes.to_vec(),
                buffer: vec![0; 256],
                animations: vec![0; 64],
                is_gltf: true,
                emptied: vec![true; meshes],
            };
            let image = SkeletonImage { bytes: b"\x89PNG".to_vec(), is_preview: has_animations };
            if let Ok(scene) = skeleton.into_scene(vec![image; images], has_animations) {
                accept_scene(&scene);
                let _ = write_glb(&scene, &[]);
            }
        }
    }
}
