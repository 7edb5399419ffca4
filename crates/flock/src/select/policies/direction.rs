//! Chains by the side of the school that is seen.

use crate::flock::School;
use crate::levels::LevelTable;
use crate::select::policies::by_school::{each_school, fill_by_distance};
use crate::select::{ChainLevels, InstanceLevel, Policy, View};

/// Gives every member a share of its triangles by its distance, from the chain whose coarsened side
/// the whole school turns away [CC05].
pub struct Direction {
    chains: SidedLevels,
}

impl Direction {
    /// Creates the policy for a table of levels.
    pub fn new(_table: &LevelTable) -> Self {
        Self { chains: SidedLevels::default() }
    }
}

impl Policy for Direction {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        self.chains.fill(view);
        each_school(view, levels, self.chains.whole(), |school, levels| {
            let by_distance = self.chains.of(view, school);
            view.assign_range(school.members.clone(), levels, |_, lanes, chosen| {
                by_distance.look_up(&lanes.distance_squared, chosen);
            });
        });
    }
}

/// Levels by distance of the whole, the left-coarsened and the right-coarsened chain.
#[derive(Default)]
pub struct SidedLevels([ChainLevels; 3]);

impl SidedLevels {
    /// Fills the levels of all three chains for a frame.
    pub fn fill(&mut self, view: &View<'_>) {
        for (levels, chain) in self.0.iter_mut().zip(&view.table.chains) {
            fill_by_distance(levels, view, chain);
        }
    }

    /// Returns the levels of the whole chain.
    pub fn whole(&self) -> &ChainLevels {
        &self.0[0]
    }

    /// Returns the levels for a school: those coarsened on the left if the camera looks towards
    /// the leader's left, within 60°, on the right if it looks that way, else the whole ones.
    pub fn of(&self, view: &View<'_>, school: &School) -> &ChainLevels {
        let [_, _, axis] = view.camera.axes();
        let towards = (school.leader - view.camera.eye()).try_normalize().unwrap_or(axis);
        let left = school.frame().x_axis.dot(towards);
        if left > 0.5 {
            &self.0[1]
        } else if left < -0.5 {
            &self.0[2]
        } else {
            &self.0[0]
        }
    }
}
