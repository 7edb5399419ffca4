//! Levels of a model for its thousands of instances, and pictures of them.

use std::sync::{Arc, OnceLock};

use meshlod::flock::draw::FlockPainter;
use meshlod::flock::levels::{
    ChainOptions, Impostor, ImpostorOptions, LevelTable, Look, ModelAxes, TableError,
};
use meshlod::flock::select::InstanceLevel;
use meshlod::mesh::{Borders, ConditionOptions, Locks, Search, condition};
use meshlod::{Mesh, Method};
use numpy::{PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use super::member_sizes::{give_sizes, replace_impostors};
use super::members::FlockArguments;
use super::{CameraArguments, camera_of};
use crate::errors::raised;
use crate::mesh::{FaceLabels, NativeMesh, labels, name_of};
use crate::numpy_views::{given_flat, lent};
use crate::work::run;

/// All levels of a model, which never change, so that numpy can look into their memory.
#[pyclass(frozen, module = "meshlod._native")]
pub struct NativeLevelTable {
    table: Arc<LevelTable>,
    /// First triangle of each level and the one behind its last.
    ranges: Vec<[i64; 2]>,
    /// Error of each level.
    errors: Vec<f32>,
    /// Pictures of the model, made when first needed.
    impostor: OnceLock<Arc<Impostor>>,
}

/// Attributes by name, with a row of values for each vertex.
type Attributes<'py> = Vec<(String, Bound<'py, PyArray2<f32>>)>;

/// Greatest number of faces of a model: its levels for all directions take about a kilobyte a face.
const MAX_FACES: usize = 1_000_000;

/// Greatest number of triangles of a picture, each of which takes about a hundred bytes.
const MAX_DRAWN: usize = 30_000_000;

impl NativeLevelTable {
    /// Returns the table, shared.
    pub fn shared(&self) -> Arc<LevelTable> {
        Arc::clone(&self.table)
    }

    /// Returns what numpy tells of members: their levels, impostors, or that they are hidden.
    fn chosen(&self, levels: &[u16]) -> PyResult<Vec<InstanceLevel>> {
        let known = [InstanceLevel::HIDDEN, InstanceLevel::IMPOSTOR];
        let levels = levels.iter().enumerate().map(|(row, &bits)| {
            let level = usize::from(bits);
            match known.into_iter().find(|level| level.to_bits() == bits) {
                Some(level) => Ok(level),
                None if level < self.table.levels.len() => Ok(InstanceLevel::drawn(level)),
                None => {
                    let count = self.table.levels.len();
                    let only = format!("there is no level {level}, only {count}");
                    Err(raised(format_args!("levels: row {row}: {only}")))
                }
            }
        });
        levels.collect()
    }
}

#[pymethods]
#[allow(unsafe_code)]
impl NativeLevelTable {
    /// Builds the levels of a model, whose borders are sewn together.
    #[new]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        mesh: &NativeMesh,
        forward: [f64; 3],
        up: [f64; 3],
        method: &str,
        step: f64,
        coarsest: usize,
        directions: usize,
    ) -> PyResult<Self> {
        let method = method.parse::<Method>().map_err(|unknown| {
            let names = unknown.known.join(", ");
            raised(format_args!("method must be one of {names}, not {}", unknown.name))
        })?;
        let mesh = mesh.shared();
        let faces = mesh.faces.len();
        if faces > MAX_FACES {
            let most = format!("a model can have {MAX_FACES} faces, not {faces}");
            return Err(raised(format_args!("{most}: simplify it first")));
        }
        let axes = ModelAxes { forward, up };
        let options = ChainOptions { axes, method, step, coarsest, directions, locks: None };
        let table = run(py, None, move |_| built(&mesh, &options))??;
        let ranges = table.levels.iter().map(|level| {
            [level.triangles.start, level.triangles.end].map(|triangle| triangle as i64)
        });
        let (ranges, errors) = (ranges.collect(), table.levels.iter().map(|l| l.error).collect());
        Ok(Self { table: Arc::new(table), ranges, errors, impostor: OnceLock::new() })
    }

    /// Position of each vertex, as a read-only view.
    #[getter]
    fn vertices<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let positions = slf.get().table.positions.as_flattened();
        // SAFETY: they belong to the table, which never changes.
        unsafe { lent(slf.clone().into_any(), positions, 3) }
    }

    /// Vertices of each triangle, as a read-only view.
    #[getter]
    fn triangles<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let triangles = slf.get().table.triangles.as_flattened();
        // SAFETY: they belong to the table, which never changes.
        unsafe { lent(slf.clone().into_any(), triangles, 3) }
    }

    /// Name and values of each attribute.
    fn attributes<'py>(&self, py: Python<'py>) -> PyResult<Attributes<'py>> {
        let layers = self.table.layers.iter().map(|layer| {
            let values = given_flat(py, layer.values.clone(), layer.width)?;
            Ok((name_of(layer.kind, &layer.name), values))
        });
        layers.collect()
    }

    /// Names of materials, and the material of each triangle; `None` if there are none.
    fn materials<'py>(&self, py: Python<'py>) -> Option<FaceLabels<'py>> {
        labels(py, self.table.materials.as_ref()?)
    }

    /// First triangle of each level and the one behind its last, as a read-only view.
    #[getter]
    fn ranges<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        // SAFETY: they belong to the table, which never changes.
        unsafe { lent(slf.clone().into_any(), slf.get().ranges.as_flattened(), 2) }
    }

    /// Error of each level, as a read-only view of one column.
    #[getter]
    fn errors<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        // SAFETY: they belong to the table, which never changes.
        unsafe { lent(slf.clone().into_any(), &slf.get().errors, 1) }
    }

    /// Number of levels of the whole chain, which are the first.
    fn depth(&self) -> usize {
        self.table.depth()
    }

    /// Copy of a level, with the vertices that it uses.
    fn mesh(&self, py: Python<'_>, level: usize) -> PyResult<NativeMesh> {
        NativeMesh::new(py.detach(|| {
            let mut mesh = self.table.mesh(level);
            mesh.compact();
            mesh
        }))
    }

    /// Draws every member at its level, and obstacles, and returns the pixels as RGBA bytes.
    ///
    /// `scales` are the lengths of members in body lengths; those that are not 1 long are drawn at
    /// their coarsest level where they are impostors.
    #[pyo3(signature = (flock, levels, camera, obstacles, scales))]
    fn draw<'py>(
        &self,
        py: Python<'py>,
        flock: FlockArguments<'py>,
        levels: PyReadonlyArray1<'py, u16>,
        camera: CameraArguments,
        obstacles: Vec<PyRef<'py, NativeMesh>>,
        scales: Option<PyReadonlyArray1<'py, f32>>,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let (flock, camera) = (flock.to_flock()?, camera_of(camera)?);
        let mut levels = self.chosen(levels.as_slice()?)?;
        let scales = scales.map(|scales| scales.as_slice().map(<[f32]>::to_vec)).transpose()?;
        if let Some(scales) = &scales {
            replace_impostors(&mut levels, scales, &self.table);
        }
        let obstacles: Vec<Mesh> = obstacles.iter().map(|mesh| (*mesh.shared()).clone()).collect();
        let drawn: usize = levels.iter().map(|level| level.triangles(&self.table)).sum();
        if drawn > MAX_DRAWN {
            let most = format!("a picture can show {MAX_DRAWN} triangles, not {drawn}");
            return Err(raised(format_args!("{most}: choose fewer")));
        }
        let table = self.shared();
        let mut impostor = self.impostor.get().cloned();
        let needs_impostor = levels.iter().any(|level| level.is_impostor());
        let (pixels, impostor) = run(py, None, move |_| {
            let look = Look::default();
            if needs_impostor && impostor.is_none() {
                let drawn = Impostor::draw(&table, &look, &ImpostorOptions::default())?;
                impostor = Some(Arc::new(drawn));
            }
            let mut painter = FlockPainter::new(&table, &look, &obstacles);
            painter.impostor = impostor.clone();
            let mut frame = painter.frame(&flock, &levels);
            if let Some(scales) = &scales {
                give_sizes(&mut frame, &flock.members, scales);
            }
            let picture = painter.render(&frame, &camera, &camera.for_picture())?;
            Ok::<_, TableError>((picture.rgba().to_vec(), impostor))
        })?
        .map_err(raised)?;
        if let Some(impostor) = impostor {
            // Another thread may have made the same one meanwhile.
            let _ = self.impostor.set(impostor);
        }
        Ok(PyBytes::new(py, &pixels))
    }
}

fn built(mesh: &Mesh, options: &ChainOptions) -> PyResult<LevelTable> {
    let sewn =
        ConditionOptions { search: Search::All, borders: Borders::Stitch, lock_boundary: false };
    let conditioned = condition(mesh, &Locks::default(), &sewn);
    let model = conditioned.as_ref().map_or(mesh, |conditioned| &conditioned.mesh);
    LevelTable::new(model, &Look::default(), options).map_err(raised)
}
