//! Compressed `.mlq` files, which stay compressed in GPU memory.

use meshlod::Mesh;
use meshlod::codec::{CompressError, compress};

use super::{Compress, CompressedFile, SchemeArg, left_out};
use crate::failure::Failure;

impl Compress {
    pub(super) fn resident(&self, mesh: &Mesh, scene: Vec<u8>) -> Result<CompressedFile, Failure> {
        let bounds = self.attributes.bounds();
        let done = compress(mesh, self.scheme(), self.target(mesh), &bounds);
        let done = done.map_err(|error| self.refused(error))?;
        let compressed = done.compressed.with_resources(scene);
        let sizes = compressed.sizes();
        let pieces = if self.scheme == Some(SchemeArg::Parts) { "parts" } else { "blocks" };
        Ok(CompressedFile {
            sizes: [sizes.positions, sizes.connectivity, sizes.attributes + sizes.labels],
            scene: sizes.resources,
            vertices: compressed.vertices(),
            faces: compressed.faces(),
            pieces: (pieces, compressed.blocks()),
            layers: compressed.layers(),
            reached: done.reached,
            left_out: left_out(mesh, compressed.faces()),
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
