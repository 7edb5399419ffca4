//! Compressed `.mlq` files, which stay compressed in GPU memory.

use meshlod::codec::{CompressError, Compressed, Malformed, compress};
use meshlod::strip::StripQuality;
use meshlod::{Mesh, compressed_strips};

use super::{Compress, CompressedFile, SchemeArg, StripCounts};
use crate::session::failure::Failure;
use crate::session::scene_files::unused_parts;

impl Compress {
    pub(super) fn resident(&self, mesh: &Mesh, scene: Vec<u8>) -> Result<CompressedFile, Failure> {
        let bounds = self.attributes.bounds();
        let done = compress(mesh, self.scheme(), self.target(mesh), &bounds);
        let done = done.map_err(|error| self.refused(error))?;
        let compressed = if self.strips {
            let stripped = compressed_strips(done.compressed, StripQuality::QUICK);
            stripped.map_err(|error| self.failed(error))?
        } else {
            done.compressed
        };
        let compressed = compressed.with_resources(scene);
        let sizes = compressed.sizes();
        let pieces = if self.scheme == Some(SchemeArg::Parts) { "parts" } else { "blocks" };
        Ok(CompressedFile {
            sizes: [sizes.positions, sizes.connectivity, sizes.attributes + sizes.labels],
            scene: sizes.resources,
            vertices: compressed.vertices(),
            faces: compressed.faces(),
            pieces: (pieces, compressed.blocks()),
            layers: compressed.layers(),
            strips: strip_counts(&compressed).map_err(|error| self.failed(error))?,
            reached: done.reached,
            notes: unused_parts(mesh, compressed.faces()),
            remarks: Vec::new(),
            bytes: compressed.to_bytes(),
        })
    }

    /// Creates the failure for a compression error: a usage error for an invalid target, otherwise
    /// a failure that names the input file.
    pub(super) fn refused(&self, error: CompressError) -> Failure {
        match error {
            CompressError::Bits(_) | CompressError::Error(_) | CompressError::Reduction(_) => {
                Failure::usage(error)
            }
            error => self.failed(error),
        }
    }
}

/// Counts the strips of a mesh whose faces are stored so.
fn strip_counts(compressed: &Compressed) -> Result<Option<StripCounts>, Malformed> {
    let stored = compressed.stored()?;
    Ok(stored.strips.map(|strips| {
        let mut counts = StripCounts { strips: 0, indices: 0, parts_with_byte_indices: 0 };
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
