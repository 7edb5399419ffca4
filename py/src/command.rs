//! The command line, as a function.

use pyo3::prelude::*;

/// Runs the command `meshlod` with these arguments, the first of which is the name of the program,
/// and returns its exit code. Ctrl-C ends the process.
#[pyfunction]
pub fn run_command(py: Python<'_>, arguments: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| {
        meshlod_cli::end_at_signals();
        meshlod_cli::run(arguments)
    })
}
