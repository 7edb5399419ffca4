//! What a file holds: nodes that place meshes, materials, images.

use meshlod_mesh::Mesh;

use crate::gltf::SourceDocument;

/// A file's contents. A format without nodes gives one mesh under one root.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Meshes, each in its own space.
    pub meshes: Vec<SceneMesh>,
    /// Nodes; children by index. No node has two parents.
    pub nodes: Vec<Node>,
    /// The nodes without a parent that the scene shows.
    pub roots: Vec<usize>,
    /// Materials of all meshes.
    pub materials: Vec<Material>,
    /// Images of the materials, still encoded.
    pub images: Vec<Image>,
    /// The glTF document that the scene came from, if it came from one.
    ///
    /// A scene with a source is written to glTF as that document with the geometry of
    /// [`Scene::meshes`] in it; changes to the other fields do not show there. Set to `None` to
    /// write the fields alone.
    pub source: Option<SourceDocument>,
}

/// A mesh, its name and its materials.
#[derive(Clone, Debug, Default)]
pub struct SceneMesh {
    /// The file's name of it, or "".
    pub name: String,
    /// The geometry. From glTF, its `materials` labels are the primitives, in the file's order.
    pub mesh: Mesh,
    /// For each name of `mesh.materials` (for the whole mesh where it has none: one entry), the
    /// index into `Scene::materials`.
    pub materials: Vec<Option<usize>>,
}

/// A place in the scene.
#[derive(Clone, Debug, PartialEq)]
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
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// The file's name of it, or "".
    pub name: String,
    /// Linear RGBA.
    pub base_color: [f32; 4],
    /// The image that multiplies it, by index into `Scene::images`.
    pub base_color_image: Option<usize>,
}

/// An image as the file has it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// File name or the file's name of it.
    pub name: String,
    /// Encoded bytes, PNG or JPEG as a rule; empty where the file that holds them is not there.
    pub bytes: Vec<u8>,
}

/// The transform that moves nothing.
pub(crate) const IDENTITY: [[f64; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

impl Default for Node {
    fn default() -> Self {
        Self { name: String::new(), transform: IDENTITY, mesh: None, children: Vec::new() }
    }
}

impl Default for Material {
    fn default() -> Self {
        Self { name: String::new(), base_color: [1.0; 4], base_color_image: None }
    }
}

impl Scene {
    /// One mesh of that name under one nameless root; each of its material labels becomes a
    /// white material.
    pub fn from_mesh(name: impl Into<String>, mesh: Mesh) -> Self {
        let labels = mesh.materials.as_ref().map_or(&[][..], |labels| &labels.names);
        let materials: Vec<Material> = labels
            .iter()
            .map(|name| Material { name: name.clone(), ..Material::default() })
            .collect();
        let of_labels =
            if labels.is_empty() { vec![None] } else { (0..labels.len()).map(Some).collect() };
        Self {
            meshes: vec![SceneMesh { name: name.into(), mesh, materials: of_labels }],
            nodes: vec![Node { mesh: Some(0), ..Node::default() }],
            roots: vec![0],
            materials,
            ..Self::default()
        }
    }
}
