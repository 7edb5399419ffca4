//! The shared meshes by name.

use anyhow::Result;
use meshlod::io::{ReadOptions, Scene};
use meshlod::mesh::Mesh;

/// A shared file as it is; `None` where the shared meshes are not here.
pub fn read_scene(file: &str) -> Result<Option<Scene>> {
    let Some(path) = meshlod_fixtures::shared_mesh(file) else { return Ok(None) };
    Ok(Some(meshlod::io::read(&path, &ReadOptions::default())?))
}

/// A shared file as one mesh in world space; `None` where the shared meshes are not here.
pub fn read(file: &str) -> Result<Option<Mesh>> {
    Ok(read_scene(file)?.map(Scene::into_mesh))
}
