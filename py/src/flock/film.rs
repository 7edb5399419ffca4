//! Films: scenarios that run, frame by frame.

use meshlod::flock::FlockCamera;
use meshlod::samples;
use meshlod_school::scene::{Film, Scenario, ScenarioName, ScenarioOptions};
use pyo3::prelude::*;

use super::CameraArguments;
use super::members::{FlockArrays, arrays};
use crate::errors::raised;
use crate::lent_out::LentOut;
use crate::mesh::NativeMesh;
use crate::work::run;

/// A film, which one thread at a time advances.
#[pyclass(frozen, module = "meshlod._native")]
pub struct NativeFilm(LentOut<Film>);

/// Faces of the terrain of the scenario of this name, as on the command line.
const TERRAIN_FACES: usize = 40_000;

#[pymethods]
impl NativeFilm {
    /// Starts a scenario and lets its schools take shape.
    #[new]
    fn new(
        py: Python<'_>,
        scenario: &str,
        members: usize,
        schools: usize,
        seed: u64,
        size: [u32; 2],
        frame_s: f64,
    ) -> PyResult<Self> {
        let name = scenario.parse::<ScenarioName>().map_err(|unknown| {
            let names = unknown.known.join(", ");
            raised(format_args!("scenario must be one of {names}, not {}", unknown.name))
        })?;
        let film = run(py, None, move |_| {
            let terrain = (name == ScenarioName::Terrain).then(|| samples::terrain(TERRAIN_FACES));
            let terrain = terrain.as_ref();
            let options = ScenarioOptions { members, schools, seed, size, frame_s, terrain };
            Film::new(Scenario::named(name, &options)?)
        })?;
        Ok(Self(LentOut::new(film.map_err(raised)?)))
    }

    /// Advances by the time of a frame, and returns the flock and its camera.
    fn next_frame<'py>(&self, py: Python<'py>) -> PyResult<(FlockArrays<'py>, CameraArguments)> {
        let mut film = self.0.take(py)?;
        let frame = run(py, None, move |_| {
            film.next_frame().map(|(flock, camera)| (flock.clone(), camera))
        })?;
        let (flock, camera) = frame.map_err(raised)?;
        Ok((arrays(py, &flock)?, camera_arguments(&camera)))
    }

    /// Obstacles that the schools swim round, as meshes.
    fn obstacles(&self, py: Python<'_>) -> PyResult<Vec<NativeMesh>> {
        let film = self.0.take(py)?;
        let meshes = run(py, None, move |_| film.scenario().obstacle_meshes())?;
        meshes.into_iter().map(NativeMesh::new).collect()
    }
}

fn camera_arguments(camera: &FlockCamera) -> CameraArguments {
    let [_, _, forward] = camera.axes();
    let (eye, velocity) = (camera.eye().into(), camera.velocity().into());
    (eye, forward.into(), camera.fov_rad(), camera.size(), velocity, [0.0; 2])
}
