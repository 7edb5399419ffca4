//! No levels: every member in full detail.

use crate::levels::LevelTable;
use crate::select::{InstanceLevel, LANES, Policy, View};

/// Draws every member in view in full detail.
pub struct FullDetail;

impl FullDetail {
    /// Creates the policy for a table of levels.
    pub fn new(_table: &LevelTable) -> Self {
        Self
    }
}

impl Policy for FullDetail {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        view.assign(levels, |_, _, chosen| *chosen = [InstanceLevel::drawn(0); LANES]);
    }
}
