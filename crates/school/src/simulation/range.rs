//! Range of coordinates.

use glam::Vec3;

/// Greatest coordinate and length, so that single precision resolves a tenth of a body length.
pub(super) const FARTHEST: f32 = 1e6;

/// Returns true if a point is finite and near enough to the origin.
pub(super) fn is_near(point: Vec3) -> bool {
    point.to_array().iter().all(|x| x.abs() <= FARTHEST)
}
