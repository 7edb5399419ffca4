//! Attributes as integers, in the same rows as positions, each within an error bound.

mod coding;
mod packed;
mod quantizer;
#[cfg(test)]
mod tests;

use meshlod_mesh::{AttributeBounds, Layer, LayerKind, WedgeId};

pub(crate) use self::coding::LayerCoding;
pub(crate) use self::packed::PackedRows;
use crate::bytes::{Malformed, Reader};
use crate::patch::Rows;

/// Compressed attribute layer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PackedLayer {
    coding: LayerCoding,
    numbers: PackedRows,
}

/// Size and error of a compressed attribute layer.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LayerReport {
    /// Name of the attribute layer in its file.
    pub name: String,
    /// Meaning of the values in the layer, such as normals.
    pub kind: LayerKind,
    /// Compressed size of the layer in bytes, with everything needed to decode it.
    pub bytes: usize,
    /// Largest error of a value in the layer: in radians for directions, else in the unit of the
    /// values.
    pub max_error: f64,
}

impl PackedLayer {
    /// Compresses a layer; `wedges` are those of the nodes, in the order of the rows.
    pub(crate) fn new(
        layer: &Layer,
        wedges: &[WedgeId],
        rows: Rows,
        bounds: &AttributeBounds,
    ) -> Self {
        let coding = LayerCoding::new(layer, wedges, bounds);
        let numbers: Vec<u32> =
            wedges.iter().flat_map(|&wedge| coding.numbers(layer.of(wedge))).collect();
        let numbers = PackedRows::new(rows, coding.components(), &numbers);
        let mut this = Self { coding, numbers };
        let decoded = this.decode();
        let values = decoded.values.chunks_exact(layer.width);
        let error = |(&wedge, is)| this.coding.error(layer.of(wedge), is);
        this.coding.max_error = wedges.iter().zip(values).map(error).fold(0.0, f64::max);
        this
    }

    /// Decodes the values of all nodes.
    pub(crate) fn decode(&self) -> Layer {
        let numbers = self.numbers.all();
        self.layer(numbers.chunks_exact(self.numbers.components()))
    }

    /// Decodes the values of some nodes, each given by its row and its number there.
    pub(crate) fn decode_some(&self, places: &[(usize, usize)]) -> Layer {
        self.layer(places.iter().map(|&(row, number)| self.numbers.get(row, number)))
    }

    fn layer<T: AsRef<[u32]>>(&self, nodes: impl ExactSizeIterator<Item = T>) -> Layer {
        let LayerCoding { kind, ref name, width, .. } = self.coding;
        let mut values = Vec::with_capacity(nodes.len() * width);
        nodes.for_each(|numbers| self.coding.values(numbers.as_ref(), &mut values));
        Layer { kind, name: name.clone(), width, values }
    }

    pub(crate) fn kind(&self) -> LayerKind {
        self.coding.kind
    }

    /// Returns the number of values per node.
    pub(crate) fn width(&self) -> usize {
        self.coding.width
    }

    pub(crate) fn report(&self) -> LayerReport {
        LayerReport {
            kind: self.coding.kind,
            name: self.coding.name.clone(),
            bytes: self.bytes(),
            max_error: self.coding.max_error,
        }
    }

    pub(crate) fn bytes(&self) -> usize {
        self.coding.bytes() + self.numbers.bytes()
    }

    pub(crate) fn store(&self, out: &mut Vec<u8>) {
        self.coding.store(out);
        self.numbers.store(out);
    }

    pub(crate) fn restore(rows: Rows, reader: &mut Reader) -> Result<Self, Malformed> {
        let coding = LayerCoding::restore(reader)?;
        let numbers = PackedRows::restore(rows, coding.components(), reader)?;
        Ok(Self { coding, numbers })
    }
}
