//! Errors of reading and writing, with the place in the file.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Location in a file that an error refers to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileLocation {
    /// Line of a text file, counted from 1.
    Line(usize),
    /// Byte offset in a binary file, counted from 0.
    Byte(usize),
    /// Named part of the file: `header`, `accessor 7`, `node 3`.
    Part(String),
}

impl std::fmt::Display for FileLocation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Part(part) => f.write_str(part),
        }
    }
}

/// Parse error: location and reason, without the file name.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{location}: {reason}")]
pub struct ParseError {
    /// Location of the error.
    pub location: FileLocation,
    /// The problem and, where that is clear, what to do about it.
    pub reason: String,
}

impl ParseError {
    /// Creates an error at a line, counted from 1.
    pub fn line(line: usize, reason: impl Into<String>) -> Self {
        Self { location: FileLocation::Line(line), reason: reason.into() }
    }

    /// Creates an error at a byte offset, counted from 0.
    pub fn byte(byte: usize, reason: impl Into<String>) -> Self {
        Self { location: FileLocation::Byte(byte), reason: reason.into() }
    }

    /// Creates an error in a named part of the file.
    pub fn part(part: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { location: FileLocation::Part(part.into()), reason: reason.into() }
    }
}

/// Part of a scene that the output format cannot store, without the file name.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{part}: {reason}")]
pub struct Unsupported {
    /// Name of the part: `mesh 3`, `v12`.
    pub part: String,
    /// Why it cannot be stored and, where that is clear, what to do about it.
    pub reason: String,
}

impl Unsupported {
    /// Creates an error from the name of the part and the reason.
    pub fn new(part: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { part: part.into(), reason: reason.into() }
    }
}

/// Reason why a file could not be read or written. Prints as one line that starts with the file.
#[derive(Debug, Error)]
pub enum IoError {
    /// The operating system reported an error.
    #[error("{}: {source}", path.display())]
    System {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The contents are invalid.
    #[error("{}: {source}", path.display())]
    Parse {
        /// Path of the file.
        path: PathBuf,
        /// Location and reason.
        source: ParseError,
    },
    /// The format cannot store the scene.
    #[error("{}: {source}", path.display())]
    Unsupported {
        /// Path of the file.
        path: PathBuf,
        /// Part that cannot be stored, and why.
        source: Unsupported,
    },
    /// The suffix is missing or belongs to no known format.
    #[error("{}: unknown suffix; supported are {known}", path.display())]
    UnknownFormat {
        /// Path of the file.
        path: PathBuf,
        /// The supported suffixes, separated by spaces.
        known: &'static str,
    },
}

impl IoError {
    /// Wraps a system error with the path of the file.
    pub fn system(path: &Path, source: std::io::Error) -> Self {
        Self::System { path: path.to_owned(), source }
    }

    /// Wraps a parse error with the path of the file.
    pub fn parse(path: &Path, source: ParseError) -> Self {
        Self::Parse { path: path.to_owned(), source }
    }

    /// Wraps an [`Unsupported`] with the path of the file.
    pub fn unsupported(path: &Path, source: Unsupported) -> Self {
        Self::Unsupported { path: path.to_owned(), source }
    }
}
