//! Errors in reading and writing mesh files, with the location in the file.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// Location of an error within a mesh file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileLocation {
    /// Line of a text file, counted from 1.
    Line(usize),
    /// Byte offset in a binary file, counted from 0.
    Byte(usize),
    /// Named part of the file, such as `header`, `accessor 7` or `node 3`.
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

/// Error in the contents of a mesh file: its location and the reason, without the file name.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{location}: {reason}")]
pub struct ParseError {
    /// Location of the error in the mesh file.
    pub location: FileLocation,
    /// Description of the problem and, where possible, of the fix.
    pub reason: String,
}

impl ParseError {
    /// Creates a parse error at a line of a text file, counted from 1.
    pub fn line(line: usize, reason: impl Into<String>) -> Self {
        Self { location: FileLocation::Line(line), reason: reason.into() }
    }

    /// Creates a parse error at a byte offset of a binary file, counted from 0.
    pub fn byte(byte: usize, reason: impl Into<String>) -> Self {
        Self { location: FileLocation::Byte(byte), reason: reason.into() }
    }

    /// Creates a parse error in a named part of the file, such as `accessor 7`.
    pub fn part(part: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { location: FileLocation::Part(part.into()), reason: reason.into() }
    }
}

/// Error for a part of a scene that the output format cannot store; does not name the file.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{part}: {reason}")]
pub struct Unsupported {
    /// Name of the part of the scene that cannot be stored, such as `mesh 3` or `v12`.
    pub part: String,
    /// Reason why the part cannot be stored and, where possible, the fix.
    pub reason: String,
}

impl Unsupported {
    /// Creates an error from the name of the part and the reason.
    pub fn new(part: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { part: part.into(), reason: reason.into() }
    }
}

/// Reason why a mesh file could not be read or written. Prints as one line that starts with the
/// path.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum IoError {
    /// The operating system reported an error, such as a missing file.
    #[error("{}: {source}", path.display())]
    System {
        /// Path of the file that could not be read or written.
        path: PathBuf,
        /// Error reported by the operating system.
        source: std::io::Error,
    },
    /// The contents of the file are invalid.
    #[error("{}: {source}", path.display())]
    Parse {
        /// Path of the invalid file.
        path: PathBuf,
        /// Location of the error in the file, and the reason.
        source: ParseError,
    },
    /// The file format cannot store some part of the scene.
    #[error("{}: {source}", path.display())]
    Unsupported {
        /// Path of the file that was to be written.
        path: PathBuf,
        /// Part of the scene that cannot be stored, and the reason.
        source: Unsupported,
    },
    /// The file name has no suffix, or one that belongs to no supported format.
    #[error("{}: unknown suffix; supported are {known}", path.display())]
    UnknownFormat {
        /// Path of the file with the missing or unknown suffix.
        path: PathBuf,
        /// Suffixes of all supported formats, separated by spaces.
        known: &'static str,
    },
}

impl IoError {
    /// Returns the path of the file that could not be read or written.
    pub fn path(&self) -> &Path {
        match self {
            Self::System { path, .. } | Self::UnknownFormat { path, .. } => path,
            Self::Parse { path, .. } | Self::Unsupported { path, .. } => path,
        }
    }

    /// Returns the line, byte or part of the file with the error, if it is known.
    pub fn place(&self) -> Option<String> {
        match self {
            Self::Parse { source, .. } => Some(source.location.to_string()),
            Self::Unsupported { source, .. } => Some(source.part.clone()),
            Self::System { .. } | Self::UnknownFormat { .. } => None,
        }
    }

    /// Creates an error from an operating system error and the path of the file.
    pub fn system(path: &Path, source: std::io::Error) -> Self {
        Self::System { path: path.to_owned(), source }
    }

    /// Creates an error from a parse error and the path of the file.
    pub fn parse(path: &Path, source: ParseError) -> Self {
        Self::Parse { path: path.to_owned(), source }
    }

    /// Creates an error from an [`Unsupported`] and the path of the file.
    pub fn unsupported(path: &Path, source: Unsupported) -> Self {
        Self::Unsupported { path: path.to_owned(), source }
    }
}
