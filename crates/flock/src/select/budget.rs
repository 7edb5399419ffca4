//! Limits of a frame: its cost and its fineness.

use serde::{Deserialize, Serialize};

/// Limits for the choice of levels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Budget {
    /// Upper limit of the triangles of all members together. The policies `budget` and `ours` keep
    /// to it where the coarsest levels of all members in view allow; the others ignore it.
    pub triangles: usize,
    /// Fineness of the policies without a budget, above zero: distances at which levels change grow
    /// with it, and tolerated errors shrink.
    pub detail: f32,
    /// Size on the screen, in pixels of a body length, below which a drawn member becomes an
    /// [`Impostor`](crate::levels::Impostor) of two triangles, whatever level its policy chose; it
    /// gets a level again when it is a tenth larger than that. `None` for never, as well as a size
    /// that is not above zero.
    pub impostors_below_px: Option<f32>,
}

impl Default for Budget {
    fn default() -> Self {
        Self { triangles: 1_000_000, detail: 1.0, impostors_below_px: None }
    }
}
