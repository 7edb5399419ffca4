//! Writing glTF and GLB: the document that a scene was read from, with its geometry replaced.
//!
//! Reading order: `output`, which makes the document and its files; `replacer`, which puts meshes
//! into it; `arrays`, which encodes them; `buffer`, which collects the arrays. `new_document` makes
//! the document of a scene from another format, `quantized` prepares compression, `lod` adds
//! levels, `needle` writes them to files of their own.

pub(crate) mod arrays;
pub(crate) mod attribute_names;
pub(crate) mod buffer;
pub(crate) mod empty_meshes;
pub(crate) mod levels;
pub(crate) mod lod;
pub(crate) mod needle;
pub(crate) mod new_document;
pub(crate) mod node_edits;
pub(crate) mod output;
pub(crate) mod parts;
pub(crate) mod quantized;
pub(crate) mod replacer;
pub(crate) mod same_geometry;
pub(crate) mod settings;
pub(crate) mod strip_mesh;
pub(crate) mod strips;

use crate::error::Unsupported;
use crate::scene::Scene;
use levels::{Level, Levels, LodLayout};
use output::{GltfFiles, Output};
use settings::{Compression, CompressionReport};

/// Encodes a scene as a single GLB file; `levels` are its coarser levels of detail, if any.
///
/// A scene read from glTF is written as that document. Nodes, materials, animations, extras,
/// extensions and everything else pass through. An unchanged mesh keeps its arrays bit for bit; a
/// changed one gets new arrays (f32, 16-bit indices where possible, colours in their old type). The
/// buffer is rebuilt without unused data. Any other scene gets a new document with its nodes,
/// materials and images, in which each object of a mesh is a node and a mesh; meshes whose
/// coordinates 32 bits would round are stored relative to a centre, from which their nodes move
/// them back. A mesh without faces keeps one degenerate triangle, as glTF does not allow empty
/// meshes, and no node shows it unless there are levels.
///
/// With levels, every node with a mesh is named `…_LOD0` and linked by the extension `MSFT_lod` to
/// nodes `…_LOD1`, `…_LOD2` and so on, and its `extras.MSFT_screencoverage` holds the coverage at
/// which each is shown. A node that has children or is animated keeps its name, and a new child
/// takes its mesh.
///
/// # Errors
/// If a mesh is invalid or exceeds 32 bits, if the labels or the number of meshes do not match the
/// source, or above 4 GB.
pub fn write_glb(scene: &Scene, levels: &[Level]) -> Result<Vec<u8>, Unsupported> {
    Output::of(scene, levels.into(), None)?.into_glb(scene)
}

/// Encodes a scene and its coarser levels of detail as a single GLB file in the given layout.
///
/// # Errors
/// Errors of [`write_glb`].
pub fn write_lods_glb(
    scene: &Scene,
    levels: &[Level],
    layout: LodLayout,
) -> Result<Vec<u8>, Unsupported> {
    Output::of(scene, Levels { levels, layout, needle: None }, None)?.into_glb(scene)
}

/// Encodes a scene as a compressed GLB file, and returns the compressed sizes and the quantization
/// error.
///
/// Positions are quantized to a uniform grid per mesh, shared by its levels, with equal cells on
/// all axes. A vertex moves by at most half a cell per axis, and primitives that met still meet.
/// The nodes that show the mesh, or new children of them, scale and translate it back; of a skinned
/// mesh, so do the inverse bind matrices. Morph targets move vertices by whole cells. Positions
/// stay floats, as noted in the report, where this is impossible: with points or lines, materials
/// with thickness, instancing.
///
/// Normals and tangents become bytes or shorts. Texture coordinates in [0, 1] become normalised
/// integers; others stay floats. Colours in [0, 1] become bytes, unless the file had shorts, and
/// joint weights bytes that sum to 255. Everything else is kept. Faces and vertices are sorted for
/// the vertex cache. With
/// [`Compression::meshopt`], the geometry is stored in meshopt streams, and texture coordinates
/// outside [0, 1] are rounded to the requested bits as well. Images are kept.
///
/// Animations keep their channels, and at any time a pose is within
/// [`Compression::animation_degrees`] of what it was: redundant keys are dropped, rotations become
/// shorts. Cubic splines, weights and malformed samplers stay as they are. The objects of a mesh
/// stay one mesh, and have no names.
///
/// # Errors
/// Errors of [`write_glb`]; also bit counts out of range.
/// # References
/// [Kap20], [KS21]
pub fn write_compressed_glb(
    scene: &Scene,
    levels: &[Level],
    compression: &Compression,
) -> Result<(Vec<u8>, CompressionReport), Unsupported> {
    let mut output = Output::of(scene, levels.into(), Some(compression))?;
    let report = std::mem::take(&mut output.report);
    Ok((output.into_glb(scene)?, report))
}

/// Encodes a scene as a `.gltf` file named `stem.gltf` and its buffer `stem.bin`.
///
/// Images that were files stay files. See [`write_glb`].
///
/// # Errors
/// Errors of [`write_glb`], except for the size.
pub fn write(scene: &Scene, levels: &[Level], stem: &str) -> Result<GltfFiles, Unsupported> {
    Ok(files(scene, levels.into(), None, &|_| buffer_name(stem))?.0)
}

/// Encodes a scene as a compressed `.gltf` file with its buffer and images.
///
/// Files are laid out as by [`write()`] and compressed as by [`write_compressed_glb`].
///
/// # Errors
/// Errors of [`write_compressed_glb`], except for the size.
pub fn write_compressed(
    scene: &Scene,
    levels: &[Level],
    stem: &str,
    compression: &Compression,
) -> Result<(GltfFiles, CompressionReport), Unsupported> {
    files(scene, levels.into(), Some(compression), &|_| buffer_name(stem))
}

/// Encodes a scene like [`write()`] or [`write_compressed`]; `name` names the buffer by its bytes.
pub(crate) fn files(
    scene: &Scene,
    levels: Levels<'_>,
    compression: Option<&Compression>,
    name: &dyn Fn(&[u8]) -> String,
) -> Result<(GltfFiles, CompressionReport), Unsupported> {
    let mut output = Output::of(scene, levels, compression)?;
    let report = std::mem::take(&mut output.report);
    Ok((output.into_files(scene, name)?, report))
}

pub(crate) fn buffer_name(stem: &str) -> String {
    format!("{stem}.bin")
}
