//! Compressed `.mlq` files, which stay compressed in GPU memory.

use meshlod_codec::{
    CompressError, Compressed, CompressionTarget, Malformed, Reconstruction, Scheme,
};
use meshlod_mesh::{AttributeBounds, Mesh};
use meshlod_strip::StripQuality;

use super::coinciding::coinciding_vertices;
use super::part_strips::with_strips;
use super::report::{Packed, PieceCount, StripCounts};
use super::request::PositionScheme;
use crate::jobs::JobError;
use crate::jobs::unused::unused_parts;

/// Packs a mesh with the bytes of the rest of its scene.
pub(super) fn pack(
    mesh: &Mesh,
    rest: Vec<u8>,
    scheme: PositionScheme,
    target: CompressionTarget,
    bounds: &AttributeBounds,
) -> Result<Packed, JobError> {
    let (scheme, strips) = spelled(scheme);
    let done = meshlod_codec::compress(mesh, scheme, target, bounds).map_err(refused)?;
    let decoded = done.compressed.decode().map_err(JobError::output)?;
    let coinciding = coinciding_vertices(mesh, &decoded);
    let compressed = match strips {
        Some(quality) => with_strips(done.compressed, quality).map_err(JobError::input)?,
        None => done.compressed,
    };
    let compressed = compressed.with_resources(rest);
    let sizes = compressed.sizes();
    Ok(Packed {
        sizes: [sizes.positions, sizes.connectivity, sizes.attributes + sizes.labels],
        scene: sizes.resources,
        vertices: compressed.vertices(),
        coinciding: Some(coinciding),
        faces: compressed.faces(),
        pieces: match scheme {
            Scheme::Parts(_) => PieceCount::Parts(compressed.blocks()),
            _ => PieceCount::Blocks(compressed.blocks()),
        },
        layers: compressed.layers(),
        strips: strip_counts(&compressed).map_err(JobError::input)?,
        reached: done.reached,
        notes: unused_parts(mesh, compressed.faces()).into(),
        bytes: compressed.to_bytes(),
    })
}

fn spelled(scheme: PositionScheme) -> (Scheme, Option<StripQuality>) {
    match scheme {
        PositionScheme::Blocks => (Scheme::Blocks, None),
        PositionScheme::Lattice => (Scheme::Lattice, None),
        PositionScheme::Parts { strips } => (Scheme::Parts(Reconstruction::Centred), strips),
    }
}

/// Makes an invalid target an error of the request, and any other of the input.
pub(super) fn refused(error: CompressError) -> JobError {
    match error {
        CompressError::Bits(_) | CompressError::Error(_) | CompressError::Reduction(_) => {
            JobError::request("", error)
        }
        error => JobError::input(error),
    }
}

/// Counts the strips of a mesh whose faces are stored so.
fn strip_counts(compressed: &Compressed) -> Result<Option<StripCounts>, Malformed> {
    let stored = compressed.stored()?;
    Ok(stored.strips.map(|strips| {
        let mut counts = StripCounts::default();
        for part in 0..strips.parts() {
            let indices: Vec<_> = strips.indices(part).collect();
            counts.indices += indices.len();
            counts.strips +=
                indices.split(Option::is_none).filter(|strip| !strip.is_empty()).count();
            counts.parts_with_byte_indices += usize::from(strips.index_bytes(part) == 1);
        }
        counts
    }))
}
