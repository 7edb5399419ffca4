//! What a file holds: nodes that place meshes, materials, images.

use meshlod_mesh::Mesh;

/// A file's contents. A format without nodes gives one mesh under one root.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Meshes, each in its own space. A mesh's `materials` labels index `Scene::materials` by name order of its own table.
    pub meshes: Vec<SceneMesh>,
    /// Nodes; parents and children by index.
    pub nodes: Vec<Node>,
    /// The nodes without a parent that the scene shows.
    pub roots: Vec<usize>,
    /// Materials of all meshes.
    pub materials: Vec<Material>,
    /// Images of the materials, still encoded.
    pub images: Vec<Image>,
}

/// A mesh and its name.
#[derive(Clone, Debug, Default)]
pub struct SceneMesh {
    /// The file's name of it, or "".
    pub name: String,
    /// The geometry.
    pub mesh: Mesh,
    /// For each name of `mesh.materials` (for the whole mesh where it has none: one entry), the
    /// index into `Scene::materials`.
    pub materials: Vec<Option<usize>>,
}

/// A place in the scene.
#[derive(Clone, Debug)]
pub struct Node {
    /// The file's name of it, or "".
    pub name: String,
    /// Column-major 4×4: this node's space to its parent's.
    pub transform: [[f64; 4]; 4],
    /// The mesh it shows.
    pub mesh: Option<usize>,
    /// Its children.
    pub children: Vec<usize>,
}

/// What of a material a picture needs.
#[derive(Clone, Debug)]
pub struct Material {
    /// The file's name of it, or "".
    pub name: String,
    /// Linear RGBA.
    pub base_color: [f32; 4],
    /// The image that multiplies it, by index into `Scene::images`.
    pub base_color_image: Option<usize>,
}

/// An image as the file has it.
#[derive(Clone, Debug)]
pub struct Image {
    /// File name or the file's name of it.
    pub name: String,
    /// Encoded bytes: PNG or JPEG.
    pub bytes: Vec<u8>,
}
