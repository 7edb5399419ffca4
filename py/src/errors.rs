//! Errors of the crates as Python exceptions with the message of the command line.

use std::fmt;

use meshlod::IoError;
use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    meshlod,
    MeshlodError,
    PyValueError,
    "An input that is not what it should be: the message says what, where, and what to do."
);

/// Makes an exception of an error of the crates, in one line.
pub fn raised(error: impl fmt::Display) -> PyErr {
    MeshlodError::new_err(error.to_string().replace(['\n', '\r'], " "))
}

/// Makes an exception of an error with a file: `FileNotFoundError` and the like if the system
/// refused it, [`MeshlodError`] if its contents are wrong.
pub fn raised_by_file(error: IoError) -> PyErr {
    match &error {
        IoError::System { path, source } => match source.raw_os_error() {
            Some(code) => {
                PyOSError::new_err((code, without_code(source), path.display().to_string()))
            }
            None => PyOSError::new_err(error.to_string()),
        },
        _ => raised(error),
    }
}

/// Returns the message of a system error without the ` (os error 2)` that Rust adds: Python has the
/// number elsewhere.
fn without_code(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}
