//! What the fuzz targets share: seeds, and what must hold of anything that a reader lets through.
//!
//! `cargo fuzz run -s none ply` runs one of them.

mod kept;
pub mod models;
mod seeds;

use meshlod_io::Scene;
use meshlod_mesh::Mesh;

pub use kept::keep;
pub use seeds::plant;

/// Checks a mesh that a reader gave.
///
/// # Panics
/// When it breaks what [`Mesh::validate`] says must hold.
pub fn accept(mesh: &Mesh) {
    if let Err(error) = mesh.validate() {
        panic!("a reader let through a mesh whose {error}");
    }
}

/// Checks a scene that a reader gave, and its flattened mesh.
///
/// # Panics
/// When one of its meshes is not valid, or an index leads nowhere.
pub fn accept_scene(scene: &Scene) {
    for mesh in &scene.meshes {
        accept(&mesh.mesh);
    }
    accept(&scene.flatten());
}
