//! Compressed `.mlz` files for transmission.

use meshlod::Mesh;
use meshlod::Scene;
use meshlod::codec::{
    Lattice, Transport, TransportError, TransportFile, TransportOptions, TransportQuantization,
    TransportSizes,
};

use super::{Compress, CompressedFile, left_out};
use crate::failure::Failure;

impl Compress {
    pub(super) fn transport(&self, scene: Scene) -> Result<CompressedFile, Failure> {
        let mesh = scene.into_mesh();
        let options = TransportOptions {
            quantization: self.quantization(&mesh)?,
            ..TransportOptions::default()
        };
        let done = Transport::encode(&mesh, &options).map_err(|error| match error {
            TransportError::Bits(_) => Failure::usage(error),
            error => self.failed(error),
        })?;
        let file = TransportFile::open(&done.bytes).map_err(|error| self.failed(error))?;
        let mut left_out = left_out(&mesh, file.faces());
        if mesh.attributes.is_some() {
            left_out.push("left out: attributes; .mlz holds the surface only".into());
        }
        let TransportSizes { positions, connectivity, headers } = done.sizes;
        // Tables, index and coder states serve both parts, so they are shared out in proportion.
        let of_positions = headers * positions / (positions + connectivity);
        let positions = (positions + of_positions).round() as usize;
        Ok(CompressedFile {
            sizes: [positions, done.bytes.len() - positions, 0],
            vertices: file.vertices(),
            faces: file.faces(),
            pieces: ("blocks", done.blocks),
            layers: Vec::new(),
            reached: true,
            left_out,
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
