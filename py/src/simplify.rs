//! Simplification of meshes and scenes.

use std::collections::BTreeSet;

use meshlod::mesh::{Lock, Locks};
use meshlod::simplify::AttributeWeights;
use meshlod::{
    Borders, ConditionedScene, Method, Options, Scene, SceneSimplifier, Target, simplify_observed,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::raised;
use crate::mesh::NativeMesh;
use crate::report;
use crate::scene::NativeScene;
use crate::work::{Progress, run};

/// Target and options of a simplification, by the names that Python gives them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Asked {
    /// Kind of target: `count`, `ratio` or `error`.
    kind: String,
    /// Number of faces, ratio of faces or distance.
    value: f64,
    method: String,
    topology: String,
    lock_boundary: bool,
    /// Ids of the vertices to lock.
    locks: Vec<u32>,
    /// Weights of normals, texture coordinates and colours; `None` for the default.
    weights: Option<[f64; 3]>,
    progress: Option<Py<PyAny>>,
}

impl Asked {
    fn target(&self) -> PyResult<Target> {
        match self.kind.as_str() {
            "count" => Ok(Target::Faces(self.value as usize)),
            "ratio" => Ok(Target::Ratio(self.value)),
            "error" => Ok(Target::Error(self.value)),
            other => Err(raised(format_args!("there is no target {other}"))),
        }
    }

    /// Returns the options for a mesh, or a scene whose vertices are numbered mesh after mesh.
    fn options(&self, vertices: usize) -> PyResult<Options> {
        let method = self.method.parse::<Method>().map_err(|unknown| {
            let names = unknown.known.join(", ");
            raised(format_args!("method must be one of {names}, not {}", unknown.name))
        })?;
        let topology = report::topology(&self.topology).ok_or_else(|| {
            raised(format_args!("topology must be free or keep, not {}", self.topology))
        })?;
        let mut locks = Locks::default();
        if !self.locks.is_empty() {
            locks.of_vertex = vec![Lock::Free; vertices];
        }
        for &vertex in &self.locks {
            let lock = locks.of_vertex.get_mut(vertex as usize).ok_or_else(|| {
                raised(format_args!("locks: there is no vertex {vertex}, only {vertices}"))
            })?;
            *lock = Lock::Locked;
        }
        let weights = self.weights.map_or(AttributeWeights::DEFAULT, |[normal, uv, color]| {
            AttributeWeights { normal, uv, color }
        });
        let lock_boundary = self.lock_boundary;
        Ok(Options { method, topology, lock_boundary, locks, weights, ..Options::default() })
    }

    /// Returns the progress to report on a surface that shows so many `faces`, `stored` of them
    /// each once: those are the ones that are counted as they go.
    fn progress(self, faces: usize, stored: usize) -> PyResult<Option<Progress>> {
        let gone = match self.target()? {
            Target::Error(_) => None,
            target => {
                let part = target.faces_of(faces).min(faces) as f64 / faces.max(1) as f64;
                Some((stored as f64 * (1.0 - part)).ceil() as usize)
            }
        };
        Ok(self.progress.map(|callback| Progress { callback, faces: gone }))
    }
}

/// Simplifies a mesh, and returns the result and its report.
///
/// # Errors
/// An invalid mesh, target or option.
#[pyfunction]
pub fn simplify<'py>(
    py: Python<'py>,
    mesh: &NativeMesh,
    asked: Asked,
) -> PyResult<(NativeMesh, Bound<'py, PyDict>)> {
    let mesh = mesh.shared();
    let (target, options) = (asked.target()?, asked.options(mesh.positions.len())?);
    let progress = asked.progress(mesh.faces.len(), mesh.faces.len())?;
    let (level, report) =
        run(py, progress, move |watch| simplify_observed(&mesh, target, &options, watch))?
            .map_err(raised)?;
    Ok((NativeMesh::new(level)?, report::simplified(py, &report)?))
}

/// Simplifies all meshes of a scene under one target, and returns the scene and its report.
///
/// # Errors
/// An invalid mesh, target or option.
#[pyfunction]
pub fn simplify_scene<'py>(
    py: Python<'py>,
    scene: &NativeScene,
    asked: Asked,
) -> PyResult<(NativeScene, Bound<'py, PyDict>)> {
    let scene = scene.shared();
    let vertices = scene.meshes.iter().map(|mesh| mesh.mesh.positions.len()).sum();
    let (target, options) = (asked.target()?, asked.options(vertices)?);
    let faces_of = |mesh: usize| scene.meshes[mesh].mesh.faces.len();
    let instances = scene.instances();
    let shown: BTreeSet<usize> = instances.iter().map(|at| at.mesh).collect();
    let faces = instances.iter().map(|at| faces_of(at.mesh)).sum();
    let progress = asked.progress(faces, shown.into_iter().map(faces_of).sum())?;
    let (level, report) = run(py, progress, move |watch| {
        let conditioned = ConditionedScene::new(&scene, &options, Borders::Stitch)
            .map_err(|error| error.to_string())?;
        let mut simplifier =
            SceneSimplifier::new(&conditioned).map_err(|error| error.to_string())?;
        let mut report = simplifier.run(target, watch).map_err(|error| error.to_string())?;
        let meshes = simplifier.settled_level(&mut report.volume);
        let mut level: Scene = (*scene).clone();
        for (mesh, simplified) in level.meshes.iter_mut().zip(meshes) {
            mesh.mesh = simplified;
        }
        Ok::<_, String>((level, report))
    })?
    .map_err(raised)?;
    Ok((NativeScene::new(level), report::simplified(py, &report)?))
}

/// Simplifies a mesh to several ratios in one run, each level made from the one before, and returns
/// the levels with their reports.
///
/// # Errors
/// An invalid mesh, target or option.
#[pyfunction]
pub fn levels<'py>(
    py: Python<'py>,
    mesh: &NativeMesh,
    ratios: Vec<f64>,
    asked: Asked,
) -> PyResult<Vec<(NativeMesh, Bound<'py, PyDict>)>> {
    let mesh = mesh.shared();
    let options = asked.options(mesh.positions.len())?;
    let progress = asked.progress(mesh.faces.len(), mesh.faces.len())?;
    let done = run(py, progress, move |watch| {
        let scene = Scene::from_mesh("", (*mesh).clone());
        let conditioned = ConditionedScene::new(&scene, &options, Borders::Stitch)
            .map_err(|error| error.to_string())?;
        let mut simplifier =
            SceneSimplifier::new(&conditioned).map_err(|error| error.to_string())?;
        let mut levels = Vec::with_capacity(ratios.len());
        for ratio in ratios {
            let report = simplifier.run(Target::Ratio(ratio), watch);
            let mut report = report.map_err(|error| error.to_string())?;
            levels.push((simplifier.settled_level(&mut report.volume), report));
        }
        Ok::<_, String>(levels)
    })?
    .map_err(raised)?;
    let levels = done.into_iter().map(|(mut meshes, report)| {
        let mesh = NativeMesh::new(meshes.pop().unwrap_or_default())?;
        Ok((mesh, report::simplified(py, &report)?))
    });
    levels.collect()
}
