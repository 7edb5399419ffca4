//! Levels by their error in pixels.

use crate::levels::LevelTable;
use crate::select::{ChainLevels, InstanceLevel, Policy, View};

/// Gives every member the coarsest level whose error spans at most one pixel, at a detail of 1.
pub struct ScreenError {
    levels: ChainLevels,
}

impl ScreenError {
    /// Creates the policy for a table of levels.
    pub fn new(_table: &LevelTable) -> Self {
        Self { levels: ChainLevels::new() }
    }
}

impl Policy for ScreenError {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        let View { table, camera, .. } = *view;
        self.levels.fill_by_screen_error(table, camera.pixels_at_one(), view.detail());
        let by_distance = &self.levels;
        view.assign(levels, |_, lanes, chosen| {
            by_distance.look_up(&lanes.distance_squared, chosen);
        });
    }
}
