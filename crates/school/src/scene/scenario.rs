//! Scenario: schools, obstacles and camera.

use std::f32::consts::FRAC_PI_4;

use meshlod::mesh::Mesh;
use serde::{Deserialize, Serialize};

use crate::scene::lanes::{Ring, shares};
use crate::scene::setting::Setting;
use crate::scene::shot::Shot;
use crate::scene::{ScenarioName, SceneError, SceneObstacle, obstacle_course, ring, terrain};
use crate::simulation::SimulationOptions;

/// Options of a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ScenarioOptions<'a> {
    /// Number of members in all schools.
    pub members: usize,
    /// Number of schools, which share the members; at most 64.
    pub schools: usize,
    /// Seed of the simulation.
    pub seed: u64,
    /// Width and height of the pictures in pixels.
    pub size: [u32; 2],
    /// Time from frame to frame, in seconds.
    pub frame_s: f64,
    /// Terrain with +y up, in any unit: the scenario `terrain` scales it so that its shorter side
    /// covers the school's way. Not part of what serde writes and reads.
    #[serde(skip)]
    pub terrain: Option<&'a Mesh>,
}

impl Default for ScenarioOptions<'_> {
    fn default() -> Self {
        Self {
            members: 150,
            schools: 1,
            seed: 1,
            size: [960, 540],
            frame_s: 1.0 / 30.0,
            terrain: None,
        }
    }
}

/// Schools, obstacles, and a camera that follows the first school.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Name of the scenario.
    pub name: ScenarioName,
    /// Options of the simulation, with the obstacles.
    pub simulation: SimulationOptions,
    /// Obstacles of the simulation, for drawing.
    pub obstacles: Vec<SceneObstacle>,
    /// Width and height of the pictures in pixels.
    pub size: [u32; 2],
    /// Field of view along the shorter side of the pictures, in radians.
    pub fov_rad: f32,
    /// Time from frame to frame, in seconds.
    pub frame_s: f64,
    /// Time that is simulated before the first frame, in seconds.
    pub warm_up_s: f64,
    pub(super) shot: Shot,
}

impl Scenario {
    /// Sets up one of the scenarios of this crate.
    ///
    /// Everything scales with the half axes of the largest school, as
    /// [`SchoolOptions::of`](crate::simulation::SchoolOptions::of) sets them.
    /// The camera is outside all obstacles in every frame.
    ///
    /// # Errors
    /// No members, a number of schools out of range, a time from frame to frame out of range, and
    /// a scenario over terrain without one.
    pub fn named(name: ScenarioName, options: &ScenarioOptions<'_>) -> Result<Self, SceneError> {
        let counts = shares(options.members, options.schools)?;
        if !(1e-4..=60.0).contains(&options.frame_s) {
            return Err(SceneError::FrameTime(options.frame_s));
        }
        let length = Ring::of(counts[0]).radii.z;
        let circle = |distances: [f32; 2], period_s: f32| {
            let distances = distances.map(|distance| distance * length + 1.5);
            Shot::Circle { distances, period_s: f64::from((period_s * length).max(12.0)) }
        };
        let setting = match name {
            ScenarioName::Ring => ring::set_up(&counts, circle([1.4, 3.4], 3.0))?,
            ScenarioName::Inside => ring::set_up(&counts, Shot::Inside)?,
            ScenarioName::Far => ring::set_up(&counts, circle([5.0, 9.0], 8.0))?,
            ScenarioName::Obstacles => obstacle_course::set_up(&counts)?,
            ScenarioName::Terrain => {
                terrain::set_up(&counts, options.terrain.ok_or(SceneError::NoTerrain)?)?
            }
        };
        let Setting { schools, obstacles, shot, warm_up_s } = setting;
        let solids = obstacles.iter().map(SceneObstacle::for_simulation);
        let simulation = SimulationOptions {
            schools,
            obstacles: solids.collect::<Result<_, _>>()?,
            seed: options.seed,
            ..SimulationOptions::default()
        };
        Ok(Self {
            name,
            simulation,
            obstacles,
            size: options.size,
            fov_rad: FRAC_PI_4,
            frame_s: options.frame_s,
            warm_up_s: warm_up_s.into(),
            shot,
        })
    }

    /// Returns the meshes of all obstacles, for drawing.
    pub fn obstacle_meshes(&self) -> Vec<Mesh> {
        self.obstacles.iter().map(SceneObstacle::mesh).collect()
    }
}
