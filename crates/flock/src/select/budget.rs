//! Limits of a frame: its cost and its fineness.

/// Limits for the choice of levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Most triangles of all members together. The policies `budget` and `ours` keep to it where
    /// the coarsest levels of all members in view allow; the others ignore it.
    pub triangles: usize,
    /// Fineness of the policies without a budget, above zero: distances at which levels change grow
    /// with it, and tolerated errors shrink.
    pub detail: f32,
}

impl Default for Budget {
    fn default() -> Self {
        Self { triangles: 1_000_000, detail: 1.0 }
    }
}
