//! Compressed `.mlz` files for transmission.

use meshlod_codec::{
    CompressionTarget, Lattice, Transport, TransportError, TransportFile, TransportOptions,
    TransportQuantization, TransportSizes,
};
use meshlod_mesh::{AttributeBounds, Mesh};

use super::coinciding::coinciding_vertices;
use super::report::{Packed, PieceCount};
use super::resident::refused;
use crate::jobs::JobError;
use crate::jobs::unused::unused_parts;

/// Packs a mesh with the bytes of the rest of its scene.
pub(super) fn pack(
    mesh: &Mesh,
    rest: &[u8],
    on_lattice: bool,
    target: CompressionTarget,
    bounds: &AttributeBounds,
) -> Result<Packed, JobError> {
    let options = TransportOptions {
        quantization: quantization(mesh, on_lattice, target)?,
        attributes: *bounds,
        ..TransportOptions::default()
    };
    let done = Transport::encode_with_resources(mesh, rest, &options);
    let done = done.map_err(|error| match error {
        TransportError::Bits(_) => JobError::request("", error),
        error => JobError::input(error),
    })?;
    let decoded = TransportFile::open(&done.bytes).and_then(|file| file.decode());
    let decoded = decoded.map_err(JobError::output)?;
    Ok(Packed {
        sizes: sizes(&done),
        scene: done.sizes.resources,
        vertices: done.vertices,
        coinciding: Some(coinciding_vertices(mesh, &decoded)),
        faces: done.faces,
        pieces: PieceCount::Blocks(done.blocks),
        strips: None,
        reached: true,
        notes: unused_parts(mesh, done.faces).into(),
        layers: done.layers,
        bytes: done.bytes,
    })
}

/// Returns whole bytes of positions, connectivity and attributes. Tables, index and coder states
/// serve all of them, so they are shared out in proportion.
fn sizes(done: &Transport) -> [usize; 3] {
    let TransportSizes { positions, connectivity, attributes, resources, headers } = done.sizes;
    let share = 1.0 + headers / (positions + connectivity + attributes);
    let [positions, attributes] =
        [positions, attributes].map(|size| (size * share).round() as usize);
    let connectivity = (done.bytes.len() - resources).saturating_sub(positions + attributes);
    [positions, connectivity, attributes]
}

/// Returns the grid whose cells meet the target.
fn quantization(
    mesh: &Mesh,
    on_lattice: bool,
    target: CompressionTarget,
) -> Result<TransportQuantization, JobError> {
    let cell = target.cell(mesh).map_err(refused)?;
    match (target, cell) {
        (_, Some(cell)) if on_lattice => {
            Lattice::within(cell).map(TransportQuantization::Lattice).map_err(JobError::input)
        }
        (CompressionTarget::Error(_), Some(cell)) => {
            let bounds = mesh.bounds();
            let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
            let bits = (longest / cell + 1.0).log2().ceil() as u32;
            Ok(TransportQuantization::Bits(bits.max(1)))
        }
        (CompressionTarget::Bits(bits), _) => Ok(TransportQuantization::Bits(bits)),
        (CompressionTarget::Reduction(_) | CompressionTarget::Error(_), _) => {
            unreachable!("a reduction, which alone has no cells, was refused")
        }
    }
}
