//! Scene: the meshes of a file, the nodes that place them, materials and images.

pub(crate) mod flatten;
pub(crate) mod image_file;
pub(crate) mod influences;
pub(crate) mod material;
pub(crate) mod normals;

use meshlod_mesh::Mesh;

use crate::gltf::document::source::SourceDocument;
use crate::notes::Note;
use crate::ply::PlyExtras;
use material::Material;

/// Contents of a mesh file: meshes, the nodes that place them, materials and images.
///
/// Formats without nodes give one mesh under one root.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Meshes of the scene, each in its own coordinate system.
    pub meshes: Vec<SceneMesh>,
    /// Nodes of the scene graph, which refer to their children by index. No node has two parents.
    pub nodes: Vec<Node>,
    /// Indices of the root nodes that the scene shows, into [`Scene::nodes`].
    pub roots: Vec<usize>,
    /// Materials used by the meshes of the scene.
    pub materials: Vec<Material>,
    /// Images used by the materials, still encoded as PNG, JPEG and the like.
    pub images: Vec<Image>,
    /// glTF document that the scene was read from; `None` for other formats.
    ///
    /// A scene with a source is written to glTF as that document with its geometry replaced by
    /// [`Scene::meshes`]; changes to the other fields are ignored. Set this to `None` to write the
    /// fields instead.
    pub source: Option<SourceDocument>,
    /// Comments and types of a PLY file that the scene was read from, for writing it as PLY again.
    pub ply: PlyExtras,
    /// True if the source format has one set of attributes per vertex, so that its vertices are
    /// split at seams; not set for glTF, where that is known.
    pub has_split_seams: bool,
    /// True if the scene was read from a text STL file of several solids; it is written to STL as
    /// text again, since binary files have no names.
    pub has_solids: bool,
    /// Notes on what the reader left out or changed; writers ignore them.
    pub notes: Vec<Note>,
}

/// Mesh of a scene, with its name and the materials of its faces.
#[derive(Clone, Debug, Default)]
pub struct SceneMesh {
    /// Name of the mesh in the file; empty if it has none.
    pub name: String,
    /// Geometry of the mesh. In a mesh read from glTF, each `materials` label is a primitive, in
    /// the order of the file.
    pub mesh: Mesh,
    /// Material of each label of `mesh.materials`, by index into [`Scene::materials`].
    ///
    /// A mesh without labels has one entry for all its faces.
    pub materials: Vec<Option<usize>>,
}

/// Node of the scene graph, which places a mesh or other nodes by a transform.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Name of the node in the file; empty if it has none.
    pub name: String,
    /// Column-major 4×4 matrix from this node's coordinate system to its parent's.
    pub transform: [[f64; 4]; 4],
    /// Mesh that the node shows, by index into [`Scene::meshes`]; `None` if it has no mesh.
    pub mesh: Option<usize>,
    /// Transforms of the copies of the mesh that the node shows, column-major 4×4 matrices from the
    /// mesh's space to this node's; empty if it shows the mesh once, at its own place.
    pub instances: Vec<[[f64; 4]; 4]>,
    /// Child nodes, by index into [`Scene::nodes`].
    pub children: Vec<usize>,
}

/// Image of a scene, still encoded as PNG, JPEG and the like.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    /// File name of the image, or the name that the glTF document gives it.
    pub name: String,
    /// Encoded bytes, usually PNG or JPEG; empty if the image file was not found.
    pub bytes: Vec<u8>,
}

/// Identity transform.
pub(crate) const IDENTITY: [[f64; 4]; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

impl Default for Node {
    fn default() -> Self {
        Self {
            name: String::new(),
            transform: IDENTITY,
            mesh: None,
            instances: Vec::new(),
            children: Vec::new(),
        }
    }
}

impl Scene {
    /// Creates a scene with a single mesh called `name` under one unnamed root; each material label
    /// of the mesh becomes a white material.
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

    /// Exchanges the meshes for those of a level, in the same order.
    pub fn swap_meshes(&mut self, level: &mut [Mesh]) {
        let meshes = self.meshes.iter_mut().map(|mesh| &mut mesh.mesh);
        meshes.zip(level).for_each(|(mesh, level)| std::mem::swap(mesh, level));
    }
}
