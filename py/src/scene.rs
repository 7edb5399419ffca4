//! Scenes in Python: all that a file holds, immutable.

use std::sync::Arc;

use meshlod::{Mesh, Scene};
use pyo3::prelude::*;

use crate::mesh::NativeMesh;

/// A scene that never changes.
#[pyclass(frozen, module = "meshlod._native")]
pub struct NativeScene(Arc<Scene>);

impl NativeScene {
    /// Takes over a scene.
    pub fn new(scene: Scene) -> Self {
        Self(Arc::new(scene))
    }

    /// Returns the scene, shared.
    pub fn shared(&self) -> Arc<Scene> {
        Arc::clone(&self.0)
    }
}

#[pymethods]
impl NativeScene {
    /// Makes a scene of one mesh.
    #[staticmethod]
    fn of(name: &str, mesh: &NativeMesh) -> Self {
        Self::new(Scene::from_mesh(name, Mesh::clone(&mesh.shared())))
    }

    /// Name of each mesh, and the mesh in its own space.
    fn meshes(&self) -> PyResult<Vec<(String, NativeMesh)>> {
        let meshes = self.0.meshes.iter();
        meshes.map(|mesh| Ok((mesh.name.clone(), NativeMesh::new(mesh.mesh.clone())?))).collect()
    }

    /// Placed meshes: the index of the mesh, and the matrix from its space to the world, in columns.
    fn instances(&self) -> Vec<(usize, [[f64; 4]; 4])> {
        self.0.instances().iter().map(|placed| (placed.mesh, placed.transform)).collect()
    }

    /// Names of the materials.
    fn materials(&self) -> Vec<String> {
        self.0.materials.iter().map(|material| material.name.clone()).collect()
    }

    /// Merges all placed meshes into one, in world space.
    fn flatten(&self) -> PyResult<NativeMesh> {
        NativeMesh::new(self.0.flatten())
    }

    /// Number of faces that the scene shows, counting every placed mesh.
    fn face_count(&self) -> usize {
        self.0.instances().iter().map(|placed| self.0.meshes[placed.mesh].mesh.faces.len()).sum()
    }

    /// Lists what a mesh lacks of the scene.
    fn beyond_mesh(&self) -> Vec<String> {
        let scene = &self.0;
        let of_source = |array| scene.source.as_ref().map_or(0, |source| source.count(array));
        let placed = scene.instances().len();
        let counts = [
            (if placed > 1 { placed } else { 0 }, "placed meshes are merged"),
            (scene.images.len(), "images"),
            (of_source("skins"), "skins"),
            (of_source("animations"), "animations"),
        ];
        let counts = counts.iter().filter(|(count, _)| *count > 0);
        counts.map(|(count, what)| format!("{count} {what}")).collect()
    }
}
