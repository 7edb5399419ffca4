//! Scenes in Python: all that a file holds, immutable.

use std::sync::Arc;

use meshlod::scene::world_bounds;
use meshlod::{Mesh, Scene};
use pyo3::prelude::*;

use crate::files::texts;
use crate::mesh::{NativeMesh, corners};

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
    fn of(py: Python<'_>, name: &str, mesh: &NativeMesh) -> Self {
        let mesh = mesh.shared();
        Self::new(py.detach(|| Scene::from_mesh(name, Mesh::clone(&mesh))))
    }

    /// Name of each mesh, and the mesh in its own space.
    fn meshes(&self, py: Python<'_>) -> PyResult<Vec<(String, NativeMesh)>> {
        let meshes = py.detach(|| self.0.meshes.clone());
        meshes.into_iter().map(|mesh| Ok((mesh.name, NativeMesh::new(mesh.mesh)?))).collect()
    }

    /// Number of meshes, placed or not.
    fn mesh_count(&self) -> usize {
        self.0.meshes.len()
    }

    /// Placed meshes: the index of the mesh, and the matrix from its space to world space, by columns.
    fn instances(&self) -> Vec<(usize, [[f64; 4]; 4])> {
        self.0.instances().iter().map(|placed| (placed.mesh, placed.transform)).collect()
    }

    /// Names of the materials.
    fn materials(&self) -> Vec<String> {
        self.0.materials.iter().map(|material| material.name.clone()).collect()
    }

    /// Least and greatest coordinates of the placed meshes in world space; `None` without faces.
    fn bounds(&self, py: Python<'_>) -> Option<[[f64; 3]; 2]> {
        corners(&py.detach(|| world_bounds(&self.0)))
    }

    /// Merges all placed meshes into one, in world space.
    fn flatten(&self, py: Python<'_>) -> PyResult<NativeMesh> {
        NativeMesh::new(py.detach(|| self.0.flatten()))
    }

    /// Number of faces that the scene shows, counting every placed mesh.
    fn face_count(&self) -> usize {
        self.0.instances().iter().map(|placed| self.0.meshes[placed.mesh].mesh.faces.len()).sum()
    }

    /// Lists what a mesh lacks of the scene.
    fn beyond_mesh(&self) -> Vec<String> {
        texts(&self.0.mesh_limits())
    }
}
