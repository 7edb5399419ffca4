//! Scenarios in open water: `ring`, `inside` and `far`.

use crate::scene::SceneError;
use crate::scene::lanes::Ring;
use crate::scene::setting::Setting;
use crate::scene::shot::Shot;

/// Tilt of the leaders' ring, as a slope.
const SLOPE: f32 = 0.15;

/// Sets up schools that swim round a slightly tilted ring.
pub(super) fn set_up(counts: &[usize], shot: Shot) -> Result<Setting, SceneError> {
    let ring = Ring::of(counts[0]);
    let height = |angle: f32| SLOPE * ring.radius * angle.sin();
    let schools = ring.schools(counts, height)?;
    Ok(Setting { schools, obstacles: Vec::new(), shot, warm_up_s: 1.0 })
}
