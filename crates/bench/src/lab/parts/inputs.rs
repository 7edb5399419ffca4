//! Meshes that are measured, read from files and written to others.

use std::path::Path;

use anyhow::{Context, Result};
use meshlod::mesh::{Mesh, face_components, weld};
use meshlod::{ReadOptions, Scene, WriteOptions};

/// Reads a file as one mesh in world space.
pub fn read(path: &Path) -> Result<Mesh> {
    Ok(meshlod::read(path, &ReadOptions::default())?.into_mesh())
}

/// Drops everything but positions, rounded as files hold them, and faces, and welds vertices at
/// one place.
pub fn bare(mesh: Mesh) -> Mesh {
    let rounded = mesh.positions.iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
    let mut bare = Mesh::new(rounded, mesh.faces);
    weld(&mut bare, 0.0);
    bare.compact();
    bare
}

/// Returns the number of connected components of a mesh as its file has them, which may be many
/// although a welded copy is of one.
pub fn part_count(mesh: &Mesh) -> usize {
    face_components(&mesh.faces, mesh.positions.len()).1
}

/// Writes a mesh to a file of its own.
pub fn write(path: &Path, mesh: &Mesh) -> Result<()> {
    let scene = Scene::from_mesh("mesh", mesh.clone());
    meshlod::write(path, &scene, &WriteOptions::default())
        .with_context(|| path.display().to_string())
}
