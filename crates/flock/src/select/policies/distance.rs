//! Levels by the distance of each member.

use crate::levels::LevelTable;
use crate::select::policies::by_school::fill_by_distance;
use crate::select::{ChainLevels, InstanceLevel, Policy, View};

/// Gives every member a share of its triangles that falls with its distance from the eye, as the
/// paper does for single objects: F(d) = 1/d [CC05].
pub struct Distance {
    levels: ChainLevels,
}

impl Distance {
    /// Creates the policy for a table of levels.
    pub fn new(_table: &LevelTable) -> Self {
        Self { levels: ChainLevels::new() }
    }
}

impl Policy for Distance {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        fill_by_distance(&mut self.levels, view, &view.table.chains[0]);
        let by_distance = &self.levels;
        view.assign(levels, |_, lanes, chosen| {
            by_distance.look_up(&lanes.distance_squared, chosen);
        });
    }
}
