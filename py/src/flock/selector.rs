//! Choice of a level for every member, frame by frame.

use meshlod::flock::select::{Budget, PolicyName, Selector};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use super::level_table::NativeLevelTable;
use super::members::FlockArguments;
use super::{CameraArguments, camera_of};
use crate::errors::raised;
use crate::lent_out::LentOut;
use crate::work::run;

/// A policy with what it keeps from frame to frame, which one thread at a time asks.
#[pyclass(frozen, module = "meshlod._native")]
pub struct NativeSelector(LentOut<Selector>);

#[pymethods]
impl NativeSelector {
    /// Makes a selector by the name of its policy.
    #[new]
    fn new(table: &NativeLevelTable, policy: &str) -> PyResult<Self> {
        let policy = policy.parse::<PolicyName>().map_err(|unknown| {
            let names = unknown.known.join(", ");
            raised(format_args!("policy must be one of {names}, not {}", unknown.name))
        })?;
        Ok(Self(LentOut::new(Selector::new(policy, table.shared()))))
    }

    /// Chooses a level for every member, and returns them with the number of triangles drawn.
    #[allow(clippy::too_many_arguments)]
    #[pyo3(signature = (flock, camera, triangles, detail, impostors_below_px, visible))]
    fn select<'py>(
        &self,
        py: Python<'py>,
        flock: FlockArguments<'py>,
        camera: CameraArguments,
        triangles: usize,
        detail: f32,
        impostors_below_px: Option<f32>,
        visible: Option<PyReadonlyArray1<'py, bool>>,
    ) -> PyResult<(Bound<'py, PyArray1<u16>>, usize)> {
        let (flock, camera) = (flock.to_flock()?, camera_of(camera)?);
        let budget = Budget { triangles, detail, impostors_below_px };
        let visible = visible.map(|mask| mask.as_slice().map(<[bool]>::to_vec)).transpose()?;
        let mut selector = self.0.take(py)?;
        let (levels, drawn) = run(py, None, move |_| {
            let chosen = selector.select_visible(&flock, &camera, &budget, visible.as_deref());
            let levels: Vec<u16> = chosen.iter().map(|level| level.to_bits()).collect();
            (levels, selector.triangles())
        })?;
        Ok((PyArray1::from_vec(py, levels), drawn))
    }
}
