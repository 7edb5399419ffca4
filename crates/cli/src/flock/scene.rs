//! Scenes by their names, for filming, evaluating and the window.

use meshlod::Mesh;
use meshlod::samples;
use meshlod_school::scene::{Scenario, ScenarioName, ScenarioOptions, SceneError};

use crate::session::failure::Failure;

/// Settings that all scenes of a run share.
#[derive(Clone, Copy, Debug)]
pub struct SceneSettings {
    pub members: usize,
    pub schools: usize,
    pub seed: u64,
    /// Width and height of the pictures in pixels.
    pub size: [u32; 2],
    /// Frames a second.
    pub fps: f64,
}

/// Faces of the terrain that the scenario of this name swims over.
const TERRAIN_FACES: usize = 40_000;

impl SceneSettings {
    /// Sets up a scene; a number of schools that it refuses is a usage error.
    pub fn scenario(&self, name: ScenarioName) -> Result<Scenario, Failure> {
        let needs_terrain = name == ScenarioName::Terrain;
        let terrain: Option<Mesh> = needs_terrain.then(|| samples::terrain(TERRAIN_FACES));
        let options = ScenarioOptions {
            members: self.members,
            schools: self.schools,
            seed: self.seed,
            size: self.size,
            frame_s: 1.0 / self.fps,
            terrain: terrain.as_ref(),
        };
        Scenario::named(name, &options).map_err(|error| match error {
            SceneError::Schools { .. } => Failure::usage(format_args!("--schools: {error}")),
            error => Failure::new(error),
        })
    }
}
