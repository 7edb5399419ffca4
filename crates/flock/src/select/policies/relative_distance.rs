//! Levels by the paper's relative distance.
// Loops over lanes become vector code, closures over arrays need not; and `clamp` keeps a NaN.
#![allow(clippy::needless_range_loop, clippy::manual_clamp)]

use glam::Vec3;

use crate::flock::School;
use crate::levels::LevelTable;
use crate::select::policies::by_school::{each_school, fill_by_distance};
use crate::select::{ChainLevels, InstanceLevel, LANES, Lanes, Policy, View};

/// Gives every member a share of its triangles by the leader's distance and its own place in the
/// school, with one dot product a member [CC05].
pub struct RelativeDistance {
    levels: ChainLevels,
    along: Along,
}

/// Direction in which relative distance grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// From the eye to the leader, which makes it the distance to first order.
    Leader,
    /// Along the view axis, as printed.
    View,
}

impl RelativeDistance {
    /// Creates the policy for a table of levels.
    pub fn new(_table: &LevelTable) -> Self {
        Self { levels: ChainLevels::new(), along: Along::Leader }
    }

    /// Returns the policy with the direction of distance as printed or corrected.
    pub fn along(self, along: Along) -> Self {
        Self { along, ..self }
    }
}

impl Policy for RelativeDistance {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        fill_by_distance(&mut self.levels, view, &view.table.chains[0]);
        let by_distance = &self.levels;
        each_school(view, levels, by_distance, |school, levels| {
            let distance = RelativeTo::new(view, school, self.along);
            view.assign_range(school.members.clone(), levels, |_, lanes, chosen| {
                by_distance.look_up(&distance.squares(lanes), chosen);
            });
        });
    }
}

/// Distance of members from the eye, as a linear function of their positions.
pub struct RelativeTo {
    direction: Vec3,
    /// Distance that the direction gives to the eye itself.
    offset: f32,
}

impl RelativeTo {
    /// Prepares the distances of a school's members in a frame.
    pub fn new(view: &View<'_>, school: &School, along: Along) -> Self {
        let [_, _, axis] = view.camera.axes();
        let to_leader = school.leader - view.camera.eye();
        let direction = match along {
            Along::Leader => to_leader.try_normalize().unwrap_or(axis),
            Along::View => axis,
        };
        // d + v·(p − leader) = v·(p − eye) + (d − v·(leader − eye)).
        Self { direction, offset: to_leader.length() - direction.dot(to_leader) }
    }

    /// Returns the squares of the distances of eight members; zero behind the eye.
    #[inline(always)]
    pub fn squares(&self, lanes: &Lanes) -> [f32; LANES] {
        let [x, y, z] = &lanes.offset;
        let v = self.direction;
        let mut squares = [0.0; LANES];
        for i in 0..LANES {
            let distance = (x[i] * v.x + y[i] * v.y + z[i] * v.z + self.offset).max(0.0);
            squares[i] = distance * distance;
        }
        squares
    }
}
