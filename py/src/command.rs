//! The command line, as functions.

use std::ffi::OsString;
use std::path::PathBuf;

use pyo3::prelude::*;

use crate::errors::raised;
use crate::work::{Progress, run};

/// Runs the command `meshlod` with these arguments, the first of which is the name of the program,
/// and returns its exit code. Ctrl-C ends the process.
#[pyfunction]
pub fn run_command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| {
        meshlod_cli::end_at_signals();
        meshlod_cli::run(arguments)
    })
}

/// Resolution of reported progress.
const STEPS: usize = 1 << 20;

/// Runs the command without a word on the standard streams, and returns its JSON. `progress` is
/// called with the part of the files of a batch that are done.
///
/// # Errors
/// The line that the command prints where it fails.
#[pyfunction]
#[pyo3(signature = (arguments, progress=None))]
pub fn answer(
    py: Python<'_>,
    arguments: Vec<OsString>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let progress = progress.map(|callback| Progress { callback, faces: Some(STEPS) });
    run(py, progress, move |watch| {
        let watch = watch.clone();
        meshlod_cli::answer_of(arguments, move |done, all| {
            let steps = done as f64 / all.max(1) as f64 * STEPS as f64;
            watch.reach(steps as usize);
        })
    })?
    .map_err(raised)
}

/// Does one file of a batch and returns its report as JSON; see `meshlod_cli`.
#[pyfunction]
pub fn run_file_of_batch(
    py: Python<'_>,
    arguments: Vec<OsString>,
    input: PathBuf,
    output: PathBuf,
) -> PyResult<String> {
    run(py, None, move |_| meshlod_cli::run_file_of_batch(arguments, &input, &output))
}

/// Notes in the journal of `folder` that a file of a batch was made; see `meshlod_cli`.
///
/// # Errors
/// A journal that cannot be written.
#[pyfunction]
pub fn record_file_of_batch(folder: PathBuf, recipe: &str, report: &str) -> PyResult<()> {
    meshlod_cli::record_file_of_batch(&folder, recipe, report).map_err(raised)
}

/// Removes what processes that were killed have left beside these paths.
#[pyfunction]
pub fn remove_abandoned(py: Python<'_>, paths: Vec<PathBuf>) {
    py.detach(|| meshlod::io::remove_abandoned(paths.iter().map(PathBuf::as_path)));
}
