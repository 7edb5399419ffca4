//! Levels by speed over the screen.

use crate::levels::LevelTable;
use crate::select::policies::by_school::fill_by_distance;
use crate::select::{ChainLevels, InstanceLevel, Policy, View};

/// Gives every member a share of its triangles by its distance, and fewer the faster it crosses the
/// screen, where the eye cannot follow detail.
pub struct Speed {
    levels: ChainLevels,
}

/// Speed over the screen at which a member counts as twice as far away: half the picture's width a
/// second. Chosen by eye.
const HALF_SPEED: f32 = 0.5;

impl Speed {
    /// Creates the policy for a table of levels.
    pub fn new(_table: &LevelTable) -> Self {
        Self { levels: ChainLevels::new() }
    }
}

impl Policy for Speed {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        fill_by_distance(&mut self.levels, view, &view.table.chains[0]);
        let (by_distance, members) = (&self.levels, &view.flock.members);
        let width_at_one = 2.0 * view.camera.tangents()[0];
        view.assign(levels, |first, lanes, chosen| {
            for (lane, level) in chosen.iter_mut().enumerate().take(members.len() - first) {
                let member = first + lane;
                let offset = members.position(member) - view.camera.eye();
                let velocity =
                    members.heading(member) * members.speed[member] - view.camera.velocity();
                let square = lanes.distance_squared[lane];
                let across = velocity - offset * (velocity.dot(offset) / square.max(1e-6));
                let angular = across.length() / square.max(1e-6).sqrt();
                let factor = 1.0 + angular / (width_at_one * HALF_SPEED);
                *level = by_distance.at_squared(square * factor * factor);
            }
        });
    }
}
