//! Simplification of meshes and scenes.

use std::collections::BTreeSet;

use meshlod::io::{Precision, SceneMesh};
use meshlod::jobs::{self, LodsRequest, SimplifyRequest, WrittenAs};
use meshlod::mesh::{Lock, Locks};
use meshlod::scene::rounding_of_level;
use meshlod::simplify::{AttributeWeights, Digits};
use meshlod::{Constraints, Format, Mesh, Method, Scene, Target, VertexLocking};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::raised;
use crate::mesh::NativeMesh;
use crate::report;
use crate::scene::NativeScene;
use crate::work::{Progress, Watch, run};

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
    polish: bool,
    /// Ids of the vertices to lock.
    locks: Vec<u32>,
    /// Weights of normals, texture coordinates and colours; `None` for the default.
    weights: Option<[f64; 3]>,
    /// Precision of coordinates for which an error is proved: `auto`, `f32` or `f64`.
    precision: String,
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

    fn method(&self) -> PyResult<Method> {
        self.method.parse::<Method>().map_err(|unknown| {
            let names = unknown.known.join(", ");
            raised(format_args!("method must be one of {names}, not {}", unknown.name))
        })
    }

    fn weights(&self) -> AttributeWeights {
        self.weights.map_or(AttributeWeights::DEFAULT, |[normal, uv, color]| AttributeWeights {
            normal,
            uv,
            color,
        })
    }

    /// Returns the constraints on a scene, whose first mesh has the vertices to lock.
    fn constraints(&self, scene: &Scene) -> PyResult<Constraints> {
        let topology = report::topology(&self.topology).ok_or_else(|| {
            raised(format_args!("topology must be free or keep, not {}", self.topology))
        })?;
        let locks = match self.locks.is_empty() {
            true => VertexLocking::None,
            false => {
                let vertices = scene.meshes.first().map_or(0, |own| own.mesh.positions.len());
                VertexLocking::Given(vec![self.locks_of(vertices)?])
            }
        };
        let lock_boundary = self.lock_boundary;
        Ok(Constraints { topology, lock_boundary, locks, ..Constraints::default() })
    }

    fn locks_of(&self, vertices: usize) -> PyResult<Locks> {
        let mut of_vertex = vec![Lock::Free; vertices];
        for &vertex in &self.locks {
            let lock = of_vertex.get_mut(vertex as usize).ok_or_else(|| {
                raised(format_args!("locks: there is no vertex {vertex}, only {vertices}"))
            })?;
            *lock = Lock::Locked;
        }
        Ok(Locks { of_vertex, ..Locks::default() })
    }

    /// Returns how the result will be written: with 32 bits, which any format has, unless they take
    /// more than half of an error.
    fn written_as(&self, scene: &Scene) -> PyResult<WrittenAs> {
        let rounding = || rounding_of_level(scene, Digits::F32);
        let precision = match self.precision.as_str() {
            "auto" if self.kind == "error" && rounding() > 0.5 * self.value => Precision::F64,
            "auto" | "f32" => Precision::F32,
            "f64" => Precision::F64,
            other => {
                let reason = format_args!("precision must be auto, f32 or f64, not {other}");
                return Err(raised(reason));
            }
        };
        Ok(WrittenAs { format: Format::Ply, precision })
    }

    fn request(&self, scene: &Scene) -> PyResult<SimplifyRequest> {
        Ok(SimplifyRequest {
            target: self.target()?.into(),
            method: self.method()?,
            weights: self.weights(),
            polish: self.polish,
            constraints: self.constraints(scene)?,
            written_as: Some(self.written_as(scene)?),
            ..SimplifyRequest::default()
        })
    }

    /// Returns the progress to report on a scene: faces are counted as they go in each mesh, not in
    /// each instance.
    fn progress(self, scene: &Scene) -> PyResult<Option<Progress>> {
        let faces_of = |mesh: usize| scene.meshes[mesh].mesh.faces.len();
        let instances = scene.instances();
        let shown: BTreeSet<usize> = instances.iter().map(|at| at.mesh).collect();
        let faces: usize = instances.iter().map(|at| faces_of(at.mesh)).sum();
        let stored: usize = shown.into_iter().map(faces_of).sum();
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
    let scene = Scene::from_mesh("", (*mesh.shared()).clone());
    let (level, report) = simplified(py, scene, asked)?;
    Ok((NativeMesh::new(only(level.meshes))?, report))
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
    let (level, report) = simplified(py, (*scene.shared()).clone(), asked)?;
    Ok((NativeScene::new(level), report))
}

fn simplified(py: Python<'_>, scene: Scene, asked: Asked) -> PyResult<(Scene, Bound<'_, PyDict>)> {
    let request = asked.request(&scene)?;
    let progress = asked.progress(&scene)?;
    let work = move |watch: &mut Watch| jobs::simplify(scene, &request, watch);
    let (level, done) = run(py, progress, work)?.map_err(raised)?;
    Ok((level, report::of_job(py, &done)?))
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
    let scene = Scene::from_mesh("", (*mesh.shared()).clone());
    let request = LodsRequest {
        levels: ratios.into_iter().map(Target::Ratio).collect(),
        method: asked.method()?,
        weights: asked.weights(),
        polish: asked.polish,
        constraints: asked.constraints(&scene)?,
        measured: false,
        ..LodsRequest::default()
    };
    let progress = asked.progress(&scene)?;
    let work = move |watch: &mut Watch| jobs::lods(scene, &request, watch);
    let (chain, done) = run(py, progress, work)?.map_err(raised)?;
    let levels = chain.levels.into_iter().zip(&done.levels).map(|(mut level, done)| {
        let mesh = NativeMesh::new(level.meshes.pop().unwrap_or_default())?;
        Ok((mesh, report::of_run(py, &done.run)?))
    });
    levels.collect()
}

fn only(mut meshes: Vec<SceneMesh>) -> Mesh {
    meshes.pop().map(|only| only.mesh).unwrap_or_default()
}
