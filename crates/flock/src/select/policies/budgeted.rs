//! Levels by size on the screen under a budget, with hysteresis, as in today's engines.

use crate::levels::LevelTable;
use crate::select::{ChainLevels, InstanceLevel, LANES, Policy, View};

/// Gives every member a share of its triangles in proportion to its size on the screen, with one
/// factor for all that keeps the sum within the budget. A member keeps its level until its size has
/// passed the switch by a tenth.
pub struct Budgeted {
    /// Levels for members that are getting coarser, and finer.
    bounds: [ChainLevels; 2],
    /// Number of members at each entry of the tables of levels.
    counts: Vec<u32>,
}

/// Part of its size by which a member must pass a switch: 10 %.
const HYSTERESIS: f32 = 1.1;

impl Budgeted {
    /// Creates the policy for a table of levels.
    pub fn new(_table: &LevelTable) -> Self {
        let bounds = [ChainLevels::new(), ChainLevels::new()];
        let counts = vec![0; bounds[0].len()];
        Self { bounds, counts }
    }

    /// Counts the members in view by distance.
    fn count(&mut self, view: &View<'_>) {
        self.counts.fill(0);
        let members = view.flock.members.len();
        for first in (0..members).step_by(LANES) {
            let lanes = view.lanes(first);
            for lane in 0..LANES.min(members - first) {
                let hidden = view.visible.is_some_and(|visible| !visible[first + lane]);
                if lanes.in_frustum[lane] && !hidden {
                    self.counts[self.bounds[0].entry(lanes.distance_squared[lane])] += 1;
                }
            }
        }
    }

    /// Returns the number of triangles if full detail ends at the distance `near`.
    fn triangles(&self, view: &View<'_>, near: f32) -> usize {
        let occupied = self.counts.iter().enumerate().filter(|(_, count)| **count > 0);
        let cost = |(entry, count): (usize, &u32)| {
            let level = level_at(view.table, near / ChainLevels::distance(entry));
            view.table.triangle_count(level) * *count as usize
        };
        occupied.map(cost).sum()
    }

    /// Returns the greatest distance of full detail that keeps to the budget, by bisection.
    fn near(&self, view: &View<'_>) -> f32 {
        let (mut low, mut high) = (-20f32, 20f32);
        for _ in 0..16 {
            let middle = 0.5 * (low + high);
            let fits = self.triangles(view, middle.exp2()) <= view.budget.triangles;
            if fits { low = middle } else { high = middle }
        }
        low.exp2()
    }
}

/// Returns the finest level of the whole chain with at most this share of the triangles.
fn level_at(table: &LevelTable, share: f32) -> usize {
    let most = share.clamp(0.0, 1.0) * table.triangle_count(0) as f32;
    let levels = table.chains[0].levels.clone();
    let fits = |level: &usize| table.triangle_count(*level) as f32 <= most + 0.5;
    levels.clone().find(fits).unwrap_or(levels.end - 1)
}

impl Policy for Budgeted {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        self.count(view);
        // Members that keep a level beyond its switch must fit, too.
        let near = self.near(view) / HYSTERESIS;
        let chain = &view.table.chains[0];
        for (bound, factor) in self.bounds.iter_mut().zip([1.0 / HYSTERESIS, HYSTERESIS]) {
            bound.fill_by_share(view.table, chain, |distance| factor * near / distance);
        }
        let [coarse, fine] = &self.bounds;
        view.assign(levels, |_, lanes, chosen| {
            for (level, &square) in chosen.iter_mut().zip(&lanes.distance_squared) {
                // In the whole chain, levels get coarser as their numbers grow.
                let bounds = [fine, coarse].map(|bound| bound.at_squared(square).to_bits());
                let middle = u16::midpoint(bounds[0], bounds[1]);
                let before = level.level().map_or(middle, |_| level.to_bits());
                *level = InstanceLevel::drawn(before.clamp(bounds[0], bounds[1]).into());
            }
        });
    }
}
