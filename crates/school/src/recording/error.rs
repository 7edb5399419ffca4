//! Errors of recordings, one line each.

use thiserror::Error;

use crate::recording::npy::NpyError;

/// Reason why a recording cannot be read.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum RecordingError {
    /// A file cannot be read.
    #[error("{file}: {reason}")]
    Missing {
        /// Name of the file.
        file: String,
        /// Message of the system.
        reason: String,
    },
    /// A JSON file is not as described.
    #[error("{file}: {reason}")]
    Json {
        /// Name of the file.
        file: String,
        /// Reason, with line and column.
        reason: String,
    },
    /// A file has another version of the format.
    #[error("{file}: version {found} of the format; this program reads version {}", super::VERSION)]
    Version {
        /// Name of the file.
        file: String,
        /// Version in the file.
        found: u32,
    },
    /// An array is damaged or of another type.
    #[error("{file}: {error}")]
    Array {
        /// Name of the file.
        file: String,
        /// Reason why the array cannot be read.
        error: NpyError,
    },
    /// The shape of an array does not match the other files.
    #[error("{file}: its shape is {found:?}, but the other files need {expected}")]
    Shape {
        /// Name of the file.
        file: String,
        /// Shape in the file.
        found: Vec<usize>,
        /// Shape that the other files need.
        expected: String,
    },
    /// A value is out of range.
    #[error("{file}: {place}: {reason}")]
    Value {
        /// Name of the file.
        file: String,
        /// Place of the value in the file.
        place: String,
        /// Reason why the value is refused.
        reason: String,
    },
}

impl RecordingError {
    /// Returns an error at a place of a file.
    pub(super) fn value(
        file: &str,
        place: impl Into<String>,
        reason: impl std::fmt::Display,
    ) -> Self {
        Self::Value { file: file.into(), place: place.into(), reason: reason.to_string() }
    }
}
