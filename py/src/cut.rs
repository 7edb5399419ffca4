//! Levels in memory that follow queries: a list of triangles that changes where a query has moved.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use meshlod::multires::{CutChange, Hierarchy, HierarchyCut, Implicit, QueryError, UpdateLimits};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use self_cell::self_cell;

use crate::errors::raised;
use crate::mesh::{NativeMesh, name_of};
use crate::numpy_views::{given, given_flat};
use crate::query::{CameraArguments, SentQuery};

/// Longest time between two looks at Ctrl-C.
const TICK: Duration = Duration::from_millis(50);

/// Triangle of an empty slot.
const EMPTY: [i32; 3] = [-1; 3];

self_cell!(
    struct OwnedCut {
        owner: Hierarchy,
        #[not_covariant]
        dependent: HierarchyCut,
    }
);

/// A cut of levels that it owns, which one thread at a time may use.
///
/// Nobody waits for the GIL while holding the lock, as whoever has the GIL may wait for the lock.
#[pyclass(frozen, module = "meshlod._native")]
pub struct NativeCut(Mutex<Shown>);

/// A cut, and the slots written since they were last told, some of them several times.
struct Shown {
    cut: OwnedCut,
    written: Vec<u32>,
}

/// Changes of an update: slots, the triangles that are in them now, splits, merges, and whether the
/// cut satisfies the query.
type Changed<'py> = (Bound<'py, PyArray1<u32>>, Bound<'py, PyArray2<i32>>, usize, usize, bool);

/// Vertices of all levels: positions, and attributes by name.
type Vertices<'py> = (Bound<'py, PyArray2<f64>>, Vec<(String, Bound<'py, PyArray2<f32>>)>);

/// Names of materials, and the material of each vertex.
type VertexMaterials<'py> = (Vec<String>, Bound<'py, PyArray1<u32>>);

impl NativeCut {
    /// Makes a cut that starts as the coarsest level.
    pub fn new(levels: Hierarchy) -> Self {
        let cut = OwnedCut::new(levels, Hierarchy::cut);
        Self(Mutex::new(Shown { cut, written: Vec::new() }))
    }

    fn lock(&self) -> MutexGuard<'_, Shown> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl NativeCut {
    /// Refines and coarsens the cut until it satisfies a query, or until a number of splits and
    /// merges or of seconds is used up.
    #[pyo3(signature = (error, camera, sphere, corners, changes, seconds))]
    #[allow(clippy::too_many_arguments)]
    fn update<'py>(
        &self,
        py: Python<'py>,
        error: f64,
        camera: Option<CameraArguments>,
        sphere: Option<([f64; 3], f64)>,
        corners: Option<[[f64; 3]; 2]>,
        changes: Option<usize>,
        seconds: Option<f64>,
    ) -> PyResult<Changed<'py>> {
        let query = SentQuery::new(error, camera, sphere, corners)?;
        let time = seconds.map(Duration::try_from_secs_f64).transpose().map_err(raised)?;
        let mut update = Update::new(query, changes, time);
        while !update.is_over() {
            py.detach(|| update.go_on(&mut self.lock())).map_err(raised)?;
            py.check_signals()?;
        }
        let (slots, triangles) = py.detach(|| self.lock().take_written());
        let CutChange { splits, merges, done, .. } = update.total;
        Ok((PyArray1::from_vec(py, slots), given(py, triangles)?, splits, merges, done))
    }

    /// Triangle of each slot; -1 where a slot is empty.
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i32>>> {
        given(py, py.detach(|| self.lock().all_triangles()))
    }

    /// Number of faces.
    fn face_count(&self, py: Python<'_>) -> usize {
        py.detach(|| self.lock().cut.with_dependent(|_, cut| cut.slot_mesh().face_count()))
    }

    /// Positions and attributes of the vertices of all levels, which the triangles refer to.
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Vertices<'py>> {
        let (positions, layers) = py.detach(|| {
            let this = self.lock();
            let levels = this.cut.borrow_owner();
            (positions(levels), with_wedges(levels).map_or_else(Vec::new, layers))
        });
        let layers = layers
            .into_iter()
            .map(|layer| Ok((layer.name, given_flat(py, layer.values, layer.width)?)));
        Ok((given(py, positions)?, layers.collect::<PyResult<_>>()?))
    }

    /// Names of the materials, and the material of the faces at each vertex; `None` if there are
    /// none.
    fn materials<'py>(&self, py: Python<'py>) -> Option<VertexMaterials<'py>> {
        let (names, of_vertices) = py.detach(|| materials(self.lock().cut.borrow_owner()))?;
        Some((names, PyArray1::from_vec(py, of_vertices)))
    }

    /// Copy of the current level.
    fn mesh(&self, py: Python<'_>) -> PyResult<NativeMesh> {
        let level = || self.lock().cut.with_dependent(|_, cut| cut.level().mesh());
        NativeMesh::new(py.detach(level))
    }
}

impl Shown {
    /// Returns the slots written since the last call, in ascending order, and what is in them.
    fn take_written(&mut self) -> (Vec<u32>, Vec<[i32; 3]>) {
        let mut slots = std::mem::take(&mut self.written);
        slots.sort_unstable();
        slots.dedup();
        let triangles = self.triangles(slots.iter().copied());
        (slots, triangles)
    }

    fn all_triangles(&self) -> Vec<[i32; 3]> {
        let slots = self.cut.with_dependent(|_, cut| cut.slot_mesh().slots());
        self.triangles(0..slots as u32)
    }

    /// Returns the vertices of the triangles in slots: wedges, or nodes without wedges.
    fn triangles(&self, slots: impl Iterator<Item = u32>) -> Vec<[i32; 3]> {
        self.cut.with_dependent(|_, cut| {
            let cut = cut.slot_mesh();
            let triangle = |slot| cut.wedges(slot).or_else(|| cut.triangle(slot));
            slots.map(|slot| triangle(slot).map_or(EMPTY, |t| t.map(|v| v as i32))).collect()
        })
    }
}

/// An update in steps, between which signals are handled.
struct Update {
    query: SentQuery,
    changes: Option<usize>,
    until: Option<Instant>,
    total: CutChange,
}

impl Update {
    fn new(query: SentQuery, changes: Option<usize>, time: Option<Duration>) -> Self {
        // A time beyond the end of the clock is no limit.
        let until = time.and_then(|time| Instant::now().checked_add(time));
        Self { query, changes, until, total: CutChange::default() }
    }

    fn is_over(&self) -> bool {
        self.total.done
            || self.changes == Some(0)
            || self.until.is_some_and(|until| Instant::now() >= until)
    }

    /// Takes a step of at most a [`TICK`].
    fn go_on(&mut self, shown: &mut Shown) -> Result<(), QueryError> {
        let left = self.until.map(|until| until.saturating_duration_since(Instant::now()));
        let time = Some(left.map_or(TICK, |left| left.min(TICK)));
        let limits = UpdateLimits { changes: self.changes, time };
        let Shown { cut, written } = shown;
        let change = cut.with_dependent_mut(|_, cut| {
            let change = cut.update(&self.query.query(), &limits)?;
            written.extend(cut.slot_mesh().touched_slots());
            Ok(change)
        })?;
        self.changes = self.changes.map(|left| left.saturating_sub(change.splits + change.merges));
        self.total.splits += change.splits;
        self.total.merges += change.merges;
        self.total.done = change.done;
        Ok(())
    }
}

/// Returns levels that have wedges, which are then the vertices.
fn with_wedges(levels: &Hierarchy) -> Option<&Implicit> {
    match levels {
        Hierarchy::Contractions(model) if model.wedge_count() > 0 => Some(model),
        _ => None,
    }
}

fn positions(levels: &Hierarchy) -> Vec<[f64; 3]> {
    let nodes = 0..levels.node_count() as u32;
    match with_wedges(levels) {
        Some(model) => nodes
            .flat_map(|node| model.wedges_of(node).map(move |_| model.position(node)))
            .collect(),
        None => nodes.map(|node| levels.position(node)).collect(),
    }
}

/// Returns the names of the materials, and the material of each wedge.
fn materials(levels: &Hierarchy) -> Option<(Vec<String>, Vec<u32>)> {
    let model = with_wedges(levels)?;
    let names = model.material_names()?.to_vec();
    let all = (0..model.wedge_count() as u32).filter_map(|wedge| model.material_of(wedge));
    Some((names, all.collect()))
}

/// Values of one attribute for all wedges.
struct LayerRows {
    name: String,
    width: usize,
    values: Vec<f32>,
}

fn layers(model: &Implicit) -> Vec<LayerRows> {
    let empty = model.layers().map(|layer| LayerRows {
        name: name_of(layer.kind, layer.name),
        width: layer.width,
        values: Vec::with_capacity(layer.width * model.wedge_count()),
    });
    let mut rows: Vec<LayerRows> = empty.collect();
    let mut values = Vec::with_capacity(model.values_per_wedge());
    for wedge in 0..model.wedge_count() as u32 {
        values.clear();
        model.append_values(wedge, &mut values);
        let mut rest = &values[..];
        for layer in &mut rows {
            let (own, others) = rest.split_at(layer.width);
            layer.values.extend(own);
            rest = others;
        }
    }
    rows
}
