//! Levels by depth in the school.

use glam::{Mat3, Vec3};

use crate::flock::School;
use crate::levels::LevelTable;
use crate::select::policies::{each_school, fill_by_distance};
use crate::select::{ChainLevels, InstanceLevel, LANES, Lanes, Policy, View};

/// Gives every member a share of its triangles by its distance, and fewer the deeper it swims in the
/// ellipsoid of its school, where others hide it [CC05].
pub struct Layer {
    levels: ChainLevels,
}

/// Factors on the distance of members by shell, from the centre outwards, four shells of equal
/// thickness, and those outside of the ellipsoid. The paper gives no numbers.
pub(crate) const SHELLS: [f32; 5] = [4.0, 3.0, 2.0, 1.4, 1.0];

impl Layer {
    /// Creates the policy for a table of levels.
    pub fn new(_table: &LevelTable) -> Self {
        Self { levels: ChainLevels::new() }
    }
}

impl Policy for Layer {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        fill_by_distance(&mut self.levels, view, &view.table.chains[0]);
        let by_distance = &self.levels;
        each_school(view, levels, by_distance, |school, levels| {
            let shells = Shells::new(view, school);
            view.assign_range(school.members.clone(), levels, |_, lanes, chosen| {
                let factors = shells.squared_factors(lanes);
                *chosen = std::array::from_fn(|i| {
                    by_distance.at_squared(lanes.distance_squared[i] * factors[i])
                });
            });
        });
    }
}

/// Shells of a school's ellipsoid.
pub(super) struct Shells {
    to_unit_ball: Mat3,
    /// Leader's place in the unit ball, seen from the eye.
    leader: Vec3,
}

impl Shells {
    pub(crate) fn new(view: &View<'_>, school: &School) -> Self {
        let to_unit_ball = school.to_unit_ball();
        Self { to_unit_ball, leader: to_unit_ball * (school.leader - view.camera.eye()) }
    }

    /// Returns the squares of the factors on the distances of eight members.
    #[inline(always)]
    pub(crate) fn squared_factors(&self, lanes: &Lanes) -> [f32; LANES] {
        let [x, y, z] = &lanes.offset;
        let Mat3 { x_axis, y_axis, z_axis } = self.to_unit_ball;
        std::array::from_fn(|i| {
            let p = x_axis * x[i] + y_axis * y[i] + z_axis * z[i] - self.leader;
            let depth = p.x * p.x + p.y * p.y + p.z * p.z;
            // Shell k reaches from k/4 to (k+1)/4 of the radius.
            let shell = usize::from(depth >= 0.0625)
                + usize::from(depth >= 0.25)
                + usize::from(depth >= 0.5625)
                + usize::from(depth >= 1.0);
            SHELLS[shell] * SHELLS[shell]
        })
    }
}
