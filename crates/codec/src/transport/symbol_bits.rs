//! Sizes of the parts of a file, in bits.

use super::TransportSizes;
use super::layers::{BlockPart, LayerFormat, LayersFormat};
use super::rans::Symbol;
use crate::attributes::{LayerCoding, LayerReport};

/// Counts the bits of symbols.
pub(super) struct SymbolBits {
    positions: f64,
    connectivity: f64,
    /// Wedges and labels.
    wedges: f64,
    layers: Vec<f64>,
    log2: Vec<f64>,
}

impl SymbolBits {
    pub(super) fn new(layers: usize) -> Self {
        let log2 = (0..=4096).map(|size| f64::from(size).log2()).collect();
        Self { positions: 0.0, connectivity: 0.0, wedges: 0.0, layers: vec![0.0; layers], log2 }
    }

    fn of(&self, symbols: &[Symbol]) -> f64 {
        let bits =
            |s: &Symbol| f64::from(s.bits) + f64::from(s.low_bits) - self.log2[usize::from(s.size)];
        symbols.iter().map(bits).sum()
    }

    /// Adds the parts of a block that follow the positions, given where each starts.
    pub(super) fn add_layers(&mut self, symbols: &[Symbol], parts: &[(BlockPart, usize)]) {
        let ends = parts.iter().skip(1).map(|&(_, start)| start).chain([symbols.len()]);
        for (&(part, start), end) in parts.iter().zip(ends) {
            let bits = self.of(&symbols[start..end]);
            match part {
                BlockPart::Layer(at) => self.layers[at] += bits,
                BlockPart::Wedges | BlockPart::Labels => self.wedges += bits,
            }
        }
    }

    /// Returns the reports of all layers.
    pub(super) fn reports(&self, format: &LayersFormat) -> Vec<LayerReport> {
        let report = |(layer, bits): (&LayerFormat, &f64)| {
            let LayerCoding { kind, name, max_error, .. } = layer.coding.clone();
            LayerReport { kind, name, bytes: (bits / 8.0).round() as usize, max_error }
        };
        format.layers.iter().zip(&self.layers).map(report).collect()
    }

    /// Returns the sizes of a file's contents in bytes, given that of all and that of resources.
    pub(super) fn sizes(&self, total: usize, resources: usize) -> TransportSizes {
        let positions = self.positions / 8.0;
        let connectivity = self.connectivity / 8.0;
        let attributes = (self.wedges + self.layers.iter().sum::<f64>()) / 8.0;
        let headers = (total - resources) as f64 - positions - connectivity - attributes;
        TransportSizes { positions, connectivity, attributes, resources, headers }
    }

    /// Adds the symbols of a block. Residuals of positions are in the given range, all else is
    /// connectivity.
    pub(super) fn add(&mut self, symbols: &[Symbol], [connectivity, positions]: [usize; 2]) {
        let of_positions = self.of(&symbols[connectivity..positions]);
        let all = self.of(symbols);
        self.positions += of_positions;
        self.connectivity += all - of_positions;
    }
}
