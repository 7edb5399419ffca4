//! Original mesh of a page, with its style and counts.

use meshlod::measure::PreparedSurface;
use meshlod::{Mesh, Scene};

use crate::page::counts::Counts;
use crate::page::style::SubjectStyle;
use crate::session::failure::Failure;

/// A scene shown on a page, with its counts and drawing style.
pub struct Subject {
    /// Name of the scene in messages: the name of a sample, or the path of a file.
    pub name: String,
    /// Title of the scene on the page.
    pub title: String,
    pub scene: Scene,
    /// The scene flattened to one mesh, in world space.
    pub mesh: Mesh,
    pub counts: Counts,
    pub style: SubjectStyle,
}

impl Subject {
    /// Creates the subject of a page; `named` holds its name and title.
    pub fn new(named: [&str; 2], scene: Scene, style: impl FnOnce(&Mesh) -> SubjectStyle) -> Self {
        let mesh = scene.flatten();
        let (counts, style) = (Counts::of(&mesh), style(&mesh));
        let [name, title] = named.map(String::from);
        Self { name, title, scene, mesh, counts, style }
    }

    /// Prepares the mesh for distance measurements.
    pub fn surface(&self) -> Result<PreparedSurface<'_>, Failure> {
        PreparedSurface::new(&self.mesh)
            .map_err(|error| Failure::new(format_args!("{}: {error}", self.name)))
    }

    /// Returns the scene with the given meshes in place of its own.
    pub fn scene_with(&self, level: Vec<Mesh>) -> Scene {
        let mut scene = self.scene.clone();
        for (mesh, level) in scene.meshes.iter_mut().zip(level) {
            mesh.mesh = level;
        }
        scene
    }

    /// Flattens the scene to one mesh, with the given meshes in place of its own.
    pub fn shown_with(&self, level: &[Mesh]) -> Mesh {
        // The source document and its images are not needed for pictures.
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
