//! Compressed `.mlz` files for transmission.

use meshlod::Mesh;
use meshlod::codec::{
    Lattice, Transport, TransportError, TransportFile, TransportOptions, TransportQuantization,
    TransportSizes,
};

use super::{Compress, CompressedFile};
use crate::session::failure::Failure;
use crate::session::scene_files::unused_parts;

impl Compress {
    pub(super) fn transport(&self, mesh: &Mesh, scene: &[u8]) -> Result<CompressedFile, Failure> {
        let options = TransportOptions {
            quantization: self.quantization(mesh)?,
            attributes: self.attributes.bounds(),
            ..TransportOptions::default()
        };
        let done = Transport::encode_with_resources(mesh, scene, &options);
        let done = done.map_err(|error| match error {
            TransportError::Bits(_) => Failure::usage(error),
            error => self.failed(error),
        })?;
        let file = TransportFile::open(&done.bytes).map_err(|error| self.failed(error))?;
        let TransportSizes { positions, connectivity, attributes, resources, headers } = done.sizes;
        // Tables, index and coder states serve all parts, so they are shared out in proportion.
        let share = 1.0 + headers / (positions + connectivity + attributes);
        let [positions, attributes] =
            [positions, attributes].map(|size| (size * share).round() as usize);
        let connectivity = (done.bytes.len() - resources).saturating_sub(positions + attributes);
        Ok(CompressedFile {
            sizes: [positions, connectivity, attributes],
            scene: resources,
            vertices: file.vertices(),
            faces: file.faces(),
            pieces: ("blocks", done.blocks),
            layers: done.layers,
            strips: None,
            reached: true,
            notes: unused_parts(mesh, file.faces()),
            remarks: Vec::new(),
            bytes: done.bytes,
        })
    }

    /// Returns the quantization grid for the target.
    fn quantization(&self, mesh: &Mesh) -> Result<TransportQuantization, Failure> {
        let Some(cell) = self.target(mesh).cell(mesh).map_err(|error| self.refused(error))? else {
            return Err(Failure::usage("--reduction does not go with .mlz; use --bits or --error"));
        };
        if self.scheme.is_some() {
            return Lattice::within(cell)
                .map(TransportQuantization::Lattice)
                .map_err(|error| self.failed(error));
        }
        let bounds = mesh.bounds();
        let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
        Ok(TransportQuantization::Bits(match self.target.error {
            Some(_) => ((longest / cell + 1.0).log2().ceil() as u32).max(1),
            None => self.bits(),
        }))
    }
}
