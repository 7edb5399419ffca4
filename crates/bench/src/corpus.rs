//! Shared benchmark meshes, read by file name.

use anyhow::Result;
use meshlod::io::{ReadOptions, Scene};
use meshlod::mesh::Mesh;

/// Reads a shared mesh file as a scene; `None` if the shared meshes are not available.
pub fn read_scene(file: &str) -> Result<Option<Scene>> {
    let Some(path) = meshlod_fixtures::shared_mesh(file) else { return Ok(None) };
    Ok(Some(meshlod::io::read(&path, &ReadOptions::default())?))
}

/// Reads a shared mesh file as a single mesh in world space; `None` if the shared meshes are not
/// available.
pub fn read(file: &str) -> Result<Option<Mesh>> {
    Ok(read_scene(file)?.map(Scene::into_mesh))
}
