//! Levels by depth in the school.
// Loops over lanes become vector code, closures over arrays need not; and `clamp` keeps a NaN.
#![allow(clippy::needless_range_loop, clippy::manual_clamp)]

use glam::{Mat3, Vec3};

use crate::flock::School;
use crate::levels::LevelTable;
use crate::select::policies::by_school::{each_school, fill_by_distance};
use crate::select::{ChainLevels, InstanceLevel, LANES, Lanes, Policy, View};

/// Gives every member a share of its triangles by its distance, and fewer the deeper it swims in the
/// ellipsoid of its school, where others hide it [CC05].
pub struct Layer {
    levels: ChainLevels,
}

/// Factors on the distance of members by shell, from the centre outwards, four shells of equal
/// thickness, and those outside of the ellipsoid. The paper gives no numbers.
pub const SHELLS: [f32; 5] = [4.0, 3.0, 2.0, 1.4, 1.0];

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
                let mut squares = lanes.distance_squared;
                shells.scale(lanes, &mut squares);
                by_distance.look_up(&squares, chosen);
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
    pub fn new(view: &View<'_>, school: &School) -> Self {
        let to_unit_ball = school.to_unit_ball();
        Self { to_unit_ball, leader: to_unit_ball * (school.leader - view.camera.eye()) }
    }

    /// Multiplies the squares of the distances of eight members by the squares of their factors.
    #[inline(always)]
    pub fn scale(&self, lanes: &Lanes, squares: &mut [f32; LANES]) {
        let [x, y, z] = &lanes.offset;
        let Mat3 { x_axis: a, y_axis: b, z_axis: c } = self.to_unit_ball;
        let leader = self.leader;
        for i in 0..LANES {
            let u = x[i] * a.x + y[i] * b.x + z[i] * c.x - leader.x;
            let v = x[i] * a.y + y[i] * b.y + z[i] * c.y - leader.y;
            let w = x[i] * a.z + y[i] * b.z + z[i] * c.z - leader.z;
            let depth = u * u + v * v + w * w;
            // Shell k reaches from k/4 to (k+1)/4 of the radius.
            let mut factor = SHELLS[0] * SHELLS[0];
            for (shell, from) in [0.0625, 0.25, 0.5625, 1.0].into_iter().enumerate() {
                let next = SHELLS[shell + 1] * SHELLS[shell + 1];
                factor = if depth >= from { next } else { factor };
            }
            squares[i] *= factor;
        }
    }
}
