//! Contents of a file: meshes, the nodes that place them, materials and images.

use meshlod_mesh::Mesh;

use crate::gltf::SourceDocument;

/// Contents of a mesh file. Formats without nodes give one mesh under one root.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Meshes, each in its own space.
    pub meshes: Vec<SceneMesh>,
    /// Nodes, which refer to their children by index. No node has two parents.
    pub nodes: Vec<Node>,
    /// Root nodes that the scene shows.
    pub roots: Vec<usize>,
    /// Materials of all meshes.
    pub materials: Vec<Material>,
    /// Images of the materials, still encoded.
    pub images: Vec<Image>,
    /// glTF document that the scene was read from, if any.
    ///
    /// A scene with a source is written to glTF as that document with its geometry replaced by
    /// [`Scene::meshes`]; changes to the other fields are ignored. Set this to `None` to write the
    /// fields instead.
    pub source: Option<SourceDocument>,
}

/// Mesh of a scene with its name and materials.
#[derive(Clone, Debug, Default)]
pub struct SceneMesh {
    /// Name in the file, or "".
    pub name: String,
    /// Geometry. From glTF, the `materials` labels are the primitives, in the order of the file.
    pub mesh: Mesh,
    /// Index into `Scene::materials` for each label of `mesh.materials`; a mesh without labels has
    /// one entry for all its faces.
    pub materials: Vec<Option<usize>>,
}

/// Node of the scene graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Name in the file, or "".
    pub name: String,
    /// Column-major 4×4 matrix from this node's space to its parent's.
    pub transform: [[f64; 4]; 4],
    /// Mesh that the node shows, by index into `Scene::meshes`.
    pub mesh: Option<usize>,
    /// Child nodes, by index into `Scene::nodes`.
    pub children: Vec<usize>,
}

/// Base colour of a material; other properties are kept only in the glTF source.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the file, or "".
    pub name: String,
    /// Base colour, linear RGBA.
    pub base_color: [f32; 4],
    /// Image that multiplies the base colour, by index into `Scene::images`.
    pub base_color_image: Option<usize>,
}

/// Encoded image.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// File name, or the name that the document gives the image.
    pub name: String,
    /// Encoded bytes, usually PNG or JPEG; empty if the image file was not found.
    pub bytes: Vec<u8>,
}

/// Identity transform.
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
    /// Wraps a mesh in a scene: one unnamed root shows it under `name`, and each of its material
    /// labels becomes a white material.
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
