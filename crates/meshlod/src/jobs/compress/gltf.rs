//! Compressed `.glb` files for other programs.

use meshlod_codec::{Parts, Reconstruction, parts_for};
use meshlod_io::gltf::{
    Compression, CompressionReport, QuantizedPart, write_compressed_glb, write_parts_glb,
};
use meshlod_io::{Format, Note, Scene};

use super::report::{Packed, PieceCount};
use super::request::{CompressTarget, GltfPacking};
use super::resident::refused;
use crate::jobs::unused::unused_parts;
use crate::jobs::{About, JobError, Remark, Watch};

/// Packs a scene as `.glb`.
pub(super) fn pack(
    scene: Scene,
    form: GltfPacking,
    target: CompressTarget,
    watch: &dyn Watch,
) -> Result<Packed, JobError> {
    match form {
        GltfPacking::Parts => pack_parts(scene, target),
        GltfPacking::Scene { normal_error, uv_error, animation_error, resident } => {
            let default = Compression::default();
            let settings = Compression {
                position_bits: target.bits_of_gltf()?,
                normal_bits: normal_error.map_or(default.normal_bits, normal_bits),
                uv_bits: uv_error.map_or(default.uv_bits, uv_bits),
                animation_degrees: animation_error.unwrap_or(default.animation_degrees),
                meshopt: !resident,
                grid: None,
            };
            pack_scene(&scene, &settings, watch)
        }
    }
}

/// Packs the whole scene with quantized attributes.
fn pack_scene(
    scene: &Scene,
    settings: &Compression,
    watch: &dyn Watch,
) -> Result<Packed, JobError> {
    let (bytes, report) = write_compressed_glb(scene, &[], settings).map_err(JobError::input)?;
    let CompressionReport { positions, connectivity, attributes, kept, .. } = report;
    kept.iter().for_each(|kept| watch.remark(&Remark::new(About::Input, kept)));
    let meshes = scene.meshes.iter().map(|mesh| &mesh.mesh);
    Ok(Packed {
        sizes: [positions, connectivity, attributes].map(|bytes| bytes.stored),
        scene: 0,
        vertices: meshes.clone().map(|mesh| mesh.positions.len()).sum(),
        coinciding: None,
        faces: meshes.map(|mesh| mesh.faces.len()).sum(),
        pieces: PieceCount::Meshes(scene.meshes.len()),
        layers: Vec::new(),
        strips: None,
        reached: true,
        notes: [scene.limits_of(Format::Glb), scene.whole_mesh_limits()].concat(),
        bytes,
    })
}

/// Packs the surface in parts, each a node with its own matrix.
fn pack_parts(scene: Scene, target: CompressTarget) -> Result<Packed, JobError> {
    // Parts have what STL has: a surface.
    let mut notes = scene.limits_of(Format::Stl);
    let mesh = scene.into_mesh();
    let done = parts_for(&mesh, Reconstruction::Centred, target.of(&mesh));
    let (parts, reached) = done.map_err(refused)?;
    let quantized = quantized(&parts);
    let bytes = write_parts_glb(&quantized).map_err(JobError::input)?;
    let faces = parts.parts().iter().map(|part| part.faces.len()).sum();
    Note::merge(&mut notes, unused_parts(&mesh, faces).into());
    // Positions are padded to four bytes, and each part has a matrix.
    let positions: usize =
        quantized.iter().map(|part| 4 * part.positions.len() + size_of_val(&part.matrix)).sum();
    let index = |part: &QuantizedPart| if part.positions.len() < 65_536 { 2 } else { 4 };
    let indices: usize = quantized.iter().map(|part| 3 * part.faces.len() * index(part)).sum();
    Ok(Packed {
        sizes: [positions, indices.min(bytes.len().saturating_sub(positions)), 0],
        scene: 0,
        vertices: parts.vertices(),
        coinciding: None,
        faces,
        pieces: PieceCount::Parts(quantized.len()),
        layers: Vec::new(),
        strips: None,
        reached,
        notes,
        bytes,
    })
}

fn quantized(parts: &Parts) -> Vec<QuantizedPart> {
    let part = |part| QuantizedPart {
        matrix: parts.matrix(part),
        positions: part.positions.clone(),
        faces: part.faces.clone(),
    };
    parts.parts().iter().map(part).collect()
}

/// Returns the smallest number of bits per component that keeps normals within an angle: half a
/// step along each of three axes.
fn normal_bits(degrees: f64) -> u32 {
    let turns = |bits: u32| 3f64.sqrt() / 2.0 / f64::from((1u32 << (bits - 1)) - 1);
    (2..16).find(|&bits| turns(bits) <= degrees.to_radians()).unwrap_or(16)
}

/// Returns the smallest number of bits that keeps texture coordinates within an error.
fn uv_bits(error: f64) -> u32 {
    (1..16).find(|&bits| 0.5 / f64::from((1u32 << bits) - 1) <= error).unwrap_or(16)
}
