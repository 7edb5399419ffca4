//! `.mlq`: drawn from as it is.

use meshlod::Mesh;
use meshlod::codec::{CompressError, compress};

use super::{Compress, Packed, SchemeName};
use crate::failure::Failure;

impl Compress {
    pub(super) fn resident(&self, mesh: &Mesh) -> Result<Packed, Failure> {
        let bounds = self.attributes.bounds();
        let done = compress(mesh, self.scheme(), self.target(mesh), &bounds);
        let done = done.map_err(|error| match error {
            CompressError::Bits(_) | CompressError::Error(_) | CompressError::Reduction(_) => {
                Failure::usage(error)
            }
            error => Failure::at(&self.input, error),
        })?;
        let (sizes, compressed) = (done.compressed.sizes(), done.compressed);
        Ok(Packed {
            sizes: [sizes.positions, sizes.connectivity, sizes.attributes],
            vertices: compressed.vertices(),
            faces: compressed.faces(),
            pieces: match self.scheme {
                SchemeName::Parts => ("parts", compressed.blocks()),
                SchemeName::Blocks | SchemeName::Lattice => ("blocks", compressed.blocks()),
            },
            layers: compressed.layers(),
            reached: done.reached,
            bytes: compressed.to_bytes(),
        })
    }
}
