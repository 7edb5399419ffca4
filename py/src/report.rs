//! Reports for Python, as dictionaries that the package makes classes of.

use meshlod::jobs::{ProvedError, SimplifyReport};
use meshlod::measure::{Distance, OneSidedDistance};
use meshlod::mesh::Conditioning;
use meshlod::scene::FlatFaces;
use meshlod::simplify::Refusal;
use meshlod::{Report, Topology};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

use crate::errors::raised;

/// Returns the report of a job as a dictionary, with what is proved of the result as it is written.
pub fn of_job<'py>(py: Python<'py>, report: &SimplifyReport) -> PyResult<Bound<'py, PyDict>> {
    let dict = of_run(py, &report.run)?;
    if let Some(ProvedError { asked, proved, rounds, rounding, .. }) = report.error {
        dict.set_item("error_asked", asked)?;
        dict.set_item("error_proved", proved)?;
        dict.set_item("error_rounds", rounds)?;
        dict.set_item("error_of_rounding", rounding)?;
    }
    if let Some(FlatFaces { gone, needed }) = report.flats {
        dict.set_item("flat_faces", gone)?;
        dict.set_item("needed_faces", needed)?;
    }
    let Conditioning { stitched_edges, stitched_vertices, split_vertices, .. } =
        report.conditioning;
    dict.set_item("stitched_edges", stitched_edges)?;
    dict.set_item("stitched_vertices", stitched_vertices)?;
    dict.set_item("split_vertices", split_vertices)?;
    dict.set_item("simplify_seconds", report.time.as_secs_f64())?;
    dict.set_item("precision", report.written_as.map(|as_| as_.precision.name()))?;
    Ok(dict)
}

/// Returns a report as a dictionary, under the keys of the command's JSON.
pub fn of_json<'py>(py: Python<'py>, report: &impl Serialize) -> PyResult<Bound<'py, PyDict>> {
    let text = serde_json::to_string(report).map_err(raised)?;
    Ok(py.import("json")?.call_method1("loads", (text,))?.cast_into::<PyDict>()?)
}

/// Returns the report of a run as a dictionary.
pub fn of_run<'py>(py: Python<'py>, report: &Report) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("method", report.method.name())?;
    dict.set_item("input_faces", report.input_faces)?;
    dict.set_item("output_faces", report.output_faces)?;
    dict.set_item("reached", report.reached)?;
    dict.set_item("error_estimate", report.error_estimate)?;
    dict.set_item("error_proved", report.proof.map(|proof| proof.proved))?;
    dict.set_item("contractions", report.contractions.edges + report.contractions.faces)?;
    dict.set_item("vanished", report.vanished)?;
    dict.set_item("handles_closed", report.handles.map(|handles| handles.closed))?;
    dict.set_item("degenerate_faces", report.degenerate_faces)?;
    dict.set_item("duplicate_faces", report.duplicate_faces)?;
    dict.set_item("non_manifold_vertices", report.non_manifold_vertices)?;
    dict.set_item("vanished_volume", report.volume.vanished)?;
    dict.set_item("locked", report.held.locked + report.held.tied)?;
    dict.set_item("volume_lost", report.volume.lost())?;
    let refusals = PyDict::new(py);
    for refusal in Refusal::ALL {
        match report.refusals.count(refusal) {
            0 => {}
            count => refusals.set_item(refusal.name(), count)?,
        }
    }
    dict.set_item("refusals", refusals)?;
    Ok(dict)
}

/// Returns a measured distance as a dictionary.
pub fn measured<'py>(py: Python<'py>, distance: &Distance) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("mean", distance.mean())?;
    dict.set_item("rms", distance.rms())?;
    dict.set_item("max", distance.max())?;
    dict.set_item("diagonal", distance.diagonal)?;
    for (name, side) in [("forward", &distance.forward), ("backward", &distance.backward)] {
        let OneSidedDistance { mean, rms, max, place } = side;
        let own = PyDict::new(py);
        own.set_item("mean", mean)?;
        own.set_item("rms", rms)?;
        own.set_item("max", max)?;
        own.set_item("max_from", place.from.to_vec())?;
        own.set_item("max_to", place.to.to_vec())?;
        dict.set_item(name, own)?;
    }
    Ok(dict)
}

/// Returns a topology by its name; `None` if there is none.
pub fn topology(name: &str) -> Option<Topology> {
    match name {
        "free" => Some(Topology::Free),
        "keep" => Some(Topology::Keep),
        _ => None,
    }
}
