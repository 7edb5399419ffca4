//! Setting of a scenario: its schools, obstacles and camera.

use crate::scene::SceneObstacle;
use crate::scene::shot::Shot;
use crate::simulation::SchoolOptions;

/// Schools, obstacles and camera of a scenario.
pub(super) struct Setting {
    pub schools: Vec<SchoolOptions>,
    pub obstacles: Vec<SceneObstacle>,
    pub shot: Shot,
    /// Time that is simulated before the first frame.
    pub warm_up_s: f32,
}
