//! Reading glTF and GLB files.

use std::sync::Arc;

use serde_json::Value;

use super::document::{self, Buffers, Document};
use super::facts::{AnimationFacts, FileFacts};
use super::{container, decompress, draco, facts, materials, mesh, nodes, unheld};
use crate::{Note, ParseError, Resolve, Scene, SceneMesh, Weld, remarks};

/// glTF document that a scene was read from; when the scene is written, all but the geometry is
/// copied from it.
///
/// Cloning is cheap.
#[derive(Clone, Debug)]
pub struct SourceDocument(pub(super) Arc<Contents>);

impl SourceDocument {
    /// Returns the number of entries of an array of the document, such as `animations`.
    pub fn count(&self, array: &str) -> usize {
        self.0.json.get(array).and_then(Value::as_array).map_or(0, Vec::len)
    }

    /// Returns the greatest factor by which a material scales texture coordinates, by
    /// `KHR_texture_transform`; at least 1.
    pub fn largest_texture_scale(&self) -> f64 {
        self.0.json.get("materials").map_or(1.0, largest_texture_scale)
    }

    /// Reports whether the document may hold normals in bytes.
    pub(crate) fn is_quantized(&self) -> bool {
        let used = self.0.json.get("extensionsUsed").and_then(Value::as_array);
        used.into_iter().flatten().any(|name| name == "KHR_mesh_quantization")
    }

    /// Returns the extensions and the bytes of the file that the document was read from.
    pub fn file_facts(&self) -> &FileFacts {
        &self.0.facts
    }

    /// Lists the animations of the document.
    pub fn animations(&self) -> Vec<AnimationFacts> {
        facts::animations(&self.0.json)
    }

    /// Returns the number of joints of each skin.
    pub fn joints(&self) -> Vec<usize> {
        facts::joints(&self.0.json)
    }

    /// Returns the number of lights that nodes place.
    pub fn lights(&self) -> usize {
        facts::lights(&self.0.json)
    }

    /// Lists the materials that have properties which [`Material`](crate::Material) lacks, by name or
    /// as `material 3`.
    pub(crate) fn richer_materials(&self) -> Vec<String> {
        materials::richer_materials(&self.0.json)
    }

    /// Lists the images that only extensions of textures name, which scenes lack.
    pub(crate) fn extension_images(&self) -> Vec<String> {
        materials::extension_images(&self.0.json)
    }

    /// Returns the set of texture coordinates that the base colour of each material uses.
    pub(crate) fn texture_sets(&self) -> Vec<u8> {
        materials::texture_sets(&self.0.json)
    }

    /// Lists what the document holds beside all that a scene's fields and notes account for.
    pub(crate) fn unheld_parts(&self) -> Vec<Note> {
        unheld::unheld_parts(&self.0.json)
    }

    /// Reports for each primitive of a mesh whether it has no normals.
    pub(crate) fn lacks_normals(&self, mesh: usize) -> Vec<bool> {
        let primitives = self.0.json["meshes"][mesh]["primitives"].as_array();
        let lacks = |primitive: &Value| primitive["attributes"].get("NORMAL").is_none();
        primitives.into_iter().flatten().map(lacks).collect()
    }
}

/// JSON and buffers of a document, and how its vertices were welded.
#[derive(Debug)]
pub(super) struct Contents {
    pub json: Value,
    pub buffers: Buffers,
    pub weld: Weld,
    /// Marks the meshes whose geometry is in the scene only; empty if all are here.
    pub emptied: Vec<bool>,
    /// Facts of the file before it was decompressed.
    pub facts: FileFacts,
}

/// Parses a glTF or GLB file, told apart by the first bytes; `resolve` loads the buffers and images
/// that it refers to.
///
/// Every mesh of the document becomes a mesh of the scene. Its material labels are the primitives
/// in order, and `SceneMesh::materials` holds their materials. Attributes become layers named as in
/// the document, with texture coordinates flipped to an origin at the lower left. Morph targets
/// become layers named `target 0 POSITION`. Skins and poses are carried through, not applied.
///
/// Supported: triangles, strips and fans; any index and component type; strides; sparse accessors;
/// `KHR_mesh_quantization`; `EXT_meshopt_compression` and `KHR_meshopt_compression`, which are
/// decompressed and removed, as is `KHR_draco_mesh_compression` with the feature `draco`;
/// `EXT_mesh_gpu_instancing`; `MSFT_lod`, of which the finest level is shown. Carried through but not
/// applied to texture coordinates: `KHR_texture_transform`.
///
/// # Errors
/// The location (`accessor 7`, `bufferView 3`) and the reason. Draco streams without the feature and
/// unknown required extensions are rejected by name, as are positions that are not finite; other
/// attributes become 0 there, with a note, and normals are computed.
/// # References
/// [Kap20]; [KS21] and [KSL25], in [`crate::meshopt`].
pub fn read(bytes: &[u8], resolve: Resolve<'_>, weld: Weld) -> Result<Scene, ParseError> {
    let (text, chunk) = container::split(bytes)?;
    let mut json: Value = serde_json::from_slice(text)
        .map_err(|error| ParseError::part("JSON", error.to_string()))?;
    document::check_head(&json)?;
    let mut buffers = document::buffers(&json, chunk, resolve)?;
    let facts = FileFacts::of(&json);
    decompress::decompress(&mut json, &mut buffers)?;
    let decoded = draco::decompress(&mut json, &mut buffers)?;
    let mut scene = Scene::default();
    scene.notes.extend((decoded.count > 0).then_some(decoded));
    let document = Document::new(&json, &buffers)?;
    scene.images = materials::images(&document, resolve)?;
    scene.materials = materials::materials(&json, scene.images.len())?;
    let mut replaced = 0;
    for index in 0..document.meshes.len() {
        let (mesh, odd) = scene_mesh(&document, index, weld, &scene)?;
        scene.meshes.push(mesh);
        replaced += odd.values;
    }
    scene.notes.extend(Some(Note::not_finite(replaced)).filter(|note| note.count > 0));
    nodes::read(&document, &mut scene)?;
    scene.ply.remarks = remarks::of_document(&json);
    forget_uris(&mut json);
    let contents = Contents { json, buffers, weld, emptied: Vec::new(), facts };
    scene.source = Some(SourceDocument(Arc::new(contents)));
    Ok(scene)
}

/// Returns the greatest factor among all texture transforms within a value; at least 1.
fn largest_texture_scale(value: &Value) -> f64 {
    let (within, own): (Vec<&Value>, _) = match value {
        Value::Array(values) => (values.iter().collect(), None),
        Value::Object(entries) => {
            (entries.values().collect(), entries.get("KHR_texture_transform"))
        }
        _ => return 1.0,
    };
    let own = own.and_then(|transform| transform["scale"].as_array()).into_iter().flatten();
    let factors = own.filter_map(Value::as_f64).map(f64::abs).filter(|factor| factor.is_finite());
    factors.chain(within.into_iter().map(largest_texture_scale)).fold(1.0, f64::max)
}

fn scene_mesh(
    document: &Document<'_>,
    index: usize,
    weld: Weld,
    scene: &Scene,
) -> Result<(SceneMesh, mesh::Replaced), ParseError> {
    let read = &document.meshes[index];
    let materials: Vec<Option<usize>> = read.primitives.iter().map(|p| p.material).collect();
    let count = scene.materials.len();
    if let Some(&material) = materials.iter().flatten().find(|&&material| material >= count) {
        return Err(document::missing("material", material, count));
    }
    let name = read.name.clone().unwrap_or_default();
    let (mesh, replaced) = mesh::read(document, index, weld)?;
    Ok((SceneMesh { name, mesh, materials }, replaced))
}

/// Removes the URIs of buffers, often most of the document, as their bytes have been loaded.
fn forget_uris(json: &mut Value) {
    let buffers = json.get_mut("buffers").and_then(Value::as_array_mut);
    for buffer in buffers.into_iter().flatten().filter_map(Value::as_object_mut) {
        buffer.remove("uri");
    }
}
