//! What can be wrong with a file, and where.

use std::path::{Path, PathBuf};

use thiserror::Error;

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileLocation {
    /// A line of a text file, counted from 1.
    Line(usize),
    /// A byte of a binary file, counted from 0.
    Byte(usize),
    /// A named part: `header`, `accessor 7`, `node 3`.
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

/// What a parser found wrong: the place and the reason, without the file's name.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{location}: {reason}")]
pub struct ParseError {
    /// Where.
    pub location: FileLocation,
    /// What is wrong there, and what to do where that is clear.
    pub reason: String,
}

impl ParseError {
    /// Wrong at a line, counted from 1.
    pub fn line(line: usize, reason: impl Into<String>) -> Self {
        Self { location: FileLocation::Line(line), reason: reason.into() }
    }

    /// Wrong at a byte, counted from 0.
    pub fn byte(byte: usize, reason: impl Into<String>) -> Self {
        Self { location: FileLocation::Byte(byte), reason: reason.into() }
    }

    /// Wrong in a named part.
    pub fn part(part: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { location: FileLocation::Part(part.into()), reason: reason.into() }
    }
}

/// What of a scene a format cannot hold: the part and the reason, without the file's name.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{part}: {reason}")]
pub struct Unsupported {
    /// Which part: `mesh 3`, `v12`.
    pub part: String,
    /// Why, and what to do where that is clear.
    pub reason: String,
}

impl Unsupported {
    /// A part that does not fit, and why.
    pub fn new(part: impl Into<String>, reason: impl Into<String>) -> Self {
        Self { part: part.into(), reason: reason.into() }
    }
}

/// Why a file was not read or written. Prints as one line that names the file.
#[derive(Debug, Error)]
pub enum IoError {
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    System {
        /// The file.
        path: PathBuf,
        /// Its reason.
        source: std::io::Error,
    },
    /// The contents are wrong.
    #[error("{}: {source}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Where and why.
        source: ParseError,
    },
    /// The format cannot hold the scene.
    #[error("{}: {source}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        source: Unsupported,
    },
    /// No format goes with the suffix.
    #[error("{}: unknown suffix; known are {known}", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// The suffixes that would do.
        known: &'static str,
    },
}

impl IoError {
    /// A system error at a path.
    pub fn system(path: &Path, source: std::io::Error) -> Self {
        Self::System { path: path.to_owned(), source }
    }

    /// A parse error at a path.
    pub fn parse(path: &Path, source: ParseError) -> Self {
        Self::Parse { path: path.to_owned(), source }
    }

    /// A scene that does not fit a format, at a path.
    pub fn unsupported(path: &Path, source: Unsupported) -> Self {
        Self::Unsupported { path: path.to_owned(), source }
    }
}
