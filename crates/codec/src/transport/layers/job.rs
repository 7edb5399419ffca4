//! One layer of one block, as the predictors see it.

use super::entries::LayerEntries;
use super::geometry::BlockGeometry;
use super::layer_format::{LayerContexts, LayerFormat};

/// Layer of a block that is being coded.
#[derive(Clone, Copy, Debug)]
pub(super) struct LayerJob<'a> {
    pub(super) geometry: &'a BlockGeometry<'a>,
    pub(super) entries: &'a LayerEntries,
    pub(super) layer: &'a LayerFormat,
    /// First contexts of the values.
    pub(super) contexts: LayerContexts,
    /// Integers of all entries, for encoders.
    pub(super) source: Option<&'a [i32]>,
}

impl LayerJob<'_> {
    /// Returns how many integers an entry has.
    pub(super) fn width(&self) -> usize {
        self.layer.most.len()
    }

    /// Returns the integers that an encoder is to code for an entry.
    pub(super) fn wanted(&self, entry: usize) -> Option<&[i32]> {
        self.source.map(|source| &source[self.width() * entry..][..self.width()])
    }
}

/// Returns the integer nearest to a prediction, from 0 to `most`.
pub(super) fn nearest(x: f64, most: u32) -> i32 {
    ((x + 0.5).floor().clamp(0.0, most.into())) as i32
}
