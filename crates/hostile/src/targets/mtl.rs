use meshlod_io::gltf::{Skeleton, SkeletonImage, write_glb};
use meshlod_io::{Scene, obj};

use crate::accept::accept_scene;

const OBJ: &[u8] = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl wood\nf 1 2 3\n";

/// Reads a library by way of a file that names it.
fn read(library: &[u8]) -> Option<Scene> {
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\0\x01\0\0\0\x01\x08\x02";
    let mut file = |name: &str| match name {
        "a.mtl" => Some(library.to_vec()),
        _ => (!name.contains('#')).then(|| png.to_vec()),
    };
    obj::read(OBJ, &mut file).ok()
}

/// Reads a library of materials, and writes it twice.
pub fn run(bytes: &[u8]) {
    let Some(scene) = read(bytes) else { return };
    accept_scene(&scene);
    // What is written says the same, and is written the same again.
    let write = |scene: &Scene| {
        let mut out = Vec::new();
        obj::write_mtl(scene, &mut out).expect("writing to memory succeeds");
        out
    };
    let written = write(&scene);
    let again = read(&written).expect("what was written can be read");
    assert_eq!(again.materials.len(), scene.materials.len());
    for (new, old) in again.materials.iter().zip(&scene.materials) {
        assert_eq!(new.base_color, old.base_color);
        assert_eq!(new.shading, old.shading);
    }
    assert_eq!(write(&again), written);
    let skeleton = Skeleton::of(&scene, vec![true]).expect("one mesh");
    let images = scene.images.iter();
    let images =
        images.map(|image| SkeletonImage { bytes: image.bytes.clone(), is_preview: false });
    let back = skeleton.into_scene(images.collect(), true).expect("our own skeleton");
    assert_eq!(back.materials, scene.materials);
    let _ = write_glb(&scene, &[]);
}
