//! What is held up to view.

use meshlod::measure::Surface;
use meshlod::{Mesh, Scene};

use crate::failure::Failure;
use crate::page::counts::Counts;
use crate::page::look::Look;

/// A scene, and how it is shown.
pub struct Subject {
    /// As messages name it: a sample, or the path of a file.
    pub name: String,
    /// What stands over it.
    pub title: String,
    pub scene: Scene,
    /// All that the scene shows, in world space.
    pub mesh: Mesh,
    pub counts: Counts,
    pub look: Look,
}

impl Subject {
    /// `named` is its name and its title.
    pub fn new(named: [&str; 2], scene: Scene, look: impl FnOnce(&Mesh) -> Look) -> Self {
        let mesh = scene.flatten();
        let (counts, look) = (Counts::of(&mesh), look(&mesh));
        let [name, title] = named.map(String::from);
        Self { name, title, scene, mesh, counts, look }
    }

    /// The mesh, ready to be measured against.
    pub fn surface(&self) -> Result<Surface<'_>, Failure> {
        Surface::new(&self.mesh)
            .map_err(|error| Failure::new(format_args!("{}: {error}", self.name)))
    }

    /// All that the scene would show with these meshes in the place of its own.
    pub fn shown_with(&self, level: &[Mesh]) -> Mesh {
        // Without the document that it came from and its images, which no picture asks it for.
        let mut scene = Scene {
            meshes: self.scene.meshes.iter().map(bare).collect(),
            nodes: self.scene.nodes.clone(),
            roots: self.scene.roots.clone(),
            materials: self.scene.materials.clone(),
            ..Scene::default()
        };
        for (mesh, level) in scene.meshes.iter_mut().zip(level) {
            mesh.mesh = level.clone();
        }
        scene.into_mesh()
    }
}

fn bare(mesh: &meshlod::io::SceneMesh) -> meshlod::io::SceneMesh {
    meshlod::io::SceneMesh {
        name: mesh.name.clone(),
        mesh: Mesh::default(),
        materials: mesh.materials.clone(),
    }
}
