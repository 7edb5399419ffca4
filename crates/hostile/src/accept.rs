//! Checks of anything a reader accepts.

use meshlod_io::Scene;
use meshlod_mesh::Mesh;

/// Checks a mesh returned by a reader.
///
/// # Panics
/// If it violates [`Mesh::validate`].
pub fn accept(mesh: &Mesh) {
    if let Err(error) = mesh.validate() {
        panic!("a reader let through a mesh whose {error}");
    }
}

/// Checks a scene returned by a reader, and its flattened mesh.
///
/// # Panics
/// If one of its meshes is invalid, or an index is out of range.
pub fn accept_scene(scene: &Scene) {
    for mesh in &scene.meshes {
        accept(&mesh.mesh);
    }
    accept(&scene.flatten());
}
