//! Levels by the angle from where the viewer looks.

use crate::levels::LevelTable;
use crate::select::policies::by_school::fill_by_distance;
use crate::select::{ChainLevels, InstanceLevel, Policy, View};

/// Gives every member a share of its triangles by its distance, and fewer the farther it is from
/// where the viewer looks, as the eye's acuity falls.
pub struct Eccentricity {
    levels: ChainLevels,
}

/// Angle at which the eye resolves half as much as where it looks, in radians: 2.3°.
const HALF_ACUITY_RAD: f32 = 0.040;

impl Eccentricity {
    /// Creates the policy for a table of levels.
    pub fn new(_table: &LevelTable) -> Self {
        Self { levels: ChainLevels::new() }
    }
}

impl Policy for Eccentricity {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        fill_by_distance(&mut self.levels, view, &view.table.chains[0]);
        let by_distance = &self.levels;
        let [right, up, forward] = view.camera.axes();
        let [x, y] = view.camera.gaze_tangents();
        let gaze = (forward + right * x + up * y).normalize();
        let radius = view.table.radius;
        view.assign(levels, |_, lanes, chosen| {
            for (lane, level) in chosen.iter_mut().enumerate() {
                let offset = glam::Vec3::from(lanes.offset.map(|axis| axis[lane]));
                let square = lanes.distance_squared[lane];
                let distance = square.max(1e-6).sqrt();
                let angle = (offset.dot(gaze) / distance).clamp(-1.0, 1.0).acos();
                // The nearest part of the member counts.
                let angle = (angle - radius / distance).max(0.0);
                let factor = 1.0 + angle / HALF_ACUITY_RAD;
                *level = by_distance.at_squared(square * factor * factor);
            }
        });
    }
}
