//! Reading glTF and GLB files.
//!
//! Reading order: [`read`], then `mesh`, `materials`, `images`, `nodes` and `instancing`.
//! `meshopt_views` decompresses and `mended` mends before; `gltf_only` lists what only glTF can hold.

pub(crate) mod gltf_only;
pub(crate) mod images;
pub(crate) mod instancing;
pub(crate) mod materials;
mod mended;
pub(crate) mod mesh;
pub(crate) mod meshopt_views;
pub(crate) mod nodes;
pub(crate) mod primitive_rows;
pub(crate) mod tiles;

use std::sync::Arc;

use serde_json::Value;

use crate::error::ParseError;
use crate::gltf::document::buffers::{BufferPart, Buffers};
use crate::gltf::document::extensions::check_head;
use crate::gltf::document::facts::FileFacts;
use crate::gltf::document::source::{Contents, SourceDocument};
use crate::gltf::document::{Document, buffers, container, missing};
use crate::gltf::draco;
use crate::notes::Note;
use crate::options::{Resolve, Weld};
use crate::remarks;
use crate::scene::{Scene, SceneMesh};
use images::read_images;
use tiles::Tile;

/// Parses a glTF or GLB file, or a b3dm tile around a GLB, recognised by its first bytes; `resolve`
/// loads its buffers and images.
///
/// Every mesh of the document becomes a mesh of the scene. Its material labels are the primitives
/// in order, and `SceneMesh::materials` holds their materials. Attributes become layers named as in
/// the document, with texture coordinates flipped to an origin at the lower left. Morph targets
/// become layers named `target 0 POSITION`. Skins and poses are kept, not applied.
///
/// Supported: triangles, strips and fans; any index and component type; strides; sparse accessors;
/// `KHR_mesh_quantization`; `EXT_meshopt_compression` and `KHR_meshopt_compression`, which are
/// decompressed and removed, as is `KHR_draco_mesh_compression` with the feature `draco`;
/// `EXT_mesh_gpu_instancing`; `MSFT_lod`, with the finest level shown. Carried through but not
/// applied to texture coordinates: `KHR_texture_transform`. Left out with a note: extensions of
/// primitives that may name vertices, such as `CESIUM_primitive_outline`. A node that a scene lists
/// although it is another's child is shown once, with a note. The centre of a tile, or of
/// `CESIUM_RTC`, becomes a node.
///
/// # Errors
/// The location (`accessor 7`, `bufferView 3`) and the reason. Draco streams without the feature,
/// unknown required extensions and positions that are not finite are rejected. Other attributes
/// that are not finite become 0 with a note; such normals are computed.
/// # References
/// [Kap20]; [KS21] and [KSL25], in [`crate::meshopt`].
pub fn read(bytes: &[u8], resolve: Resolve<'_>, weld: Weld) -> Result<Scene, ParseError> {
    let tile = tiles::unwrap(bytes)?;
    let (text, chunk) = container::split(tile.gltf)?;
    let json = parse(text)?;
    let chunk = chunk.map(|chunk| BufferPart::Held(chunk.to_vec()));
    let buffers = buffers::load(&json, chunk, &mut |name| resolve(name).map(BufferPart::Held))?;
    let Prepared { mut json, buffers, facts, notes } = prepare(json, buffers, &tile)?;
    let mut scene = Scene { notes, ..Scene::default() };
    let document = Document::new(&json, &buffers)?;
    scene.images = read_images(&document, resolve)?;
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

/// Parses the JSON of a document that can be read.
pub(crate) fn parse(text: &[u8]) -> Result<Value, ParseError> {
    let json: Value = serde_json::from_slice(text)
        .map_err(|error| ParseError::part("JSON", error.to_string()))?;
    check_head(&json)?;
    Ok(json)
}

/// Document that is decompressed and mended, and the notes on that.
pub(crate) struct Prepared {
    pub json: Value,
    pub buffers: Buffers,
    /// Facts of the file before.
    pub facts: FileFacts,
    pub notes: Vec<Note>,
}

/// Decompresses and mends a document.
pub(crate) fn prepare(
    mut json: Value,
    mut buffers: Buffers,
    tile: &Tile<'_>,
) -> Result<Prepared, ParseError> {
    let facts = FileFacts::of(&json);
    meshopt_views::decompress(&mut json, &mut buffers)?;
    let decoded = draco::decompress(&mut json, &mut buffers)?;
    let mut notes = Vec::new();
    notes.extend((decoded.count > 0).then_some(decoded));
    notes.extend(mended::part_roots_from_children(&mut json).into_iter().flatten());
    notes.extend(tile.apply_to(&mut json)?);
    notes.extend(mended::drop_vertex_names(&mut json));
    Ok(Prepared { json, buffers, facts, notes })
}

fn scene_mesh(
    document: &Document<'_>,
    index: usize,
    weld: Weld,
    scene: &Scene,
) -> Result<(SceneMesh, mesh::Replaced), ParseError> {
    let materials = materials_of(document, index, scene.materials.len())?;
    let name = document.meshes[index].name.clone().unwrap_or_default();
    let (mesh, replaced) = mesh::read(document, index, weld)?;
    Ok((SceneMesh { name, mesh, materials }, replaced))
}

/// Returns the materials of the primitives of a mesh, which must be below `count`.
pub(crate) fn materials_of(
    document: &Document<'_>,
    mesh: usize,
    count: usize,
) -> Result<Vec<Option<usize>>, ParseError> {
    let primitives = document.meshes[mesh].primitives.iter();
    let materials: Vec<Option<usize>> = primitives.map(|p| p.material).collect();
    match materials.iter().flatten().find(|&&material| material >= count) {
        Some(&material) => Err(missing("material", material, count)),
        None => Ok(materials),
    }
}

/// Removes the URIs of the loaded buffers, often most of the document.
fn forget_uris(json: &mut Value) {
    let buffers = json.get_mut("buffers").and_then(Value::as_array_mut);
    for buffer in buffers.into_iter().flatten().filter_map(Value::as_object_mut) {
        buffer.remove("uri");
    }
}
