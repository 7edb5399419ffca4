//! Failure of a command: one line of text and an exit code.

use std::fmt;
use std::path::Path;

use meshlod::IoError;
use serde_json::{Value, json};

use crate::session::files;

/// Reason why a command failed, as one line: `FILE: place: reason`.
#[derive(Debug)]
pub struct Failure {
    line: String,
    /// File that the reason is about, as messages name it.
    file: Option<String>,
    /// Line, byte or part of the file.
    place: Option<String>,
    exit_code: u8,
}

impl Failure {
    pub fn new(line: impl fmt::Display) -> Self {
        Self { line: line.to_string(), file: None, place: None, exit_code: 1 }
    }

    /// Creates a failure that begins with a file name.
    pub fn at(path: &Path, reason: impl fmt::Display) -> Self {
        let file = files::name(path);
        Self { file: Some(file.clone()), ..Self::new(format_args!("{file}: {reason}")) }
    }

    /// Adds the file that the line, which names it already, is about.
    pub fn about(self, path: &Path) -> Self {
        Self { file: Some(files::name(path)), ..self }
    }

    /// Creates a usage error, for arguments that the command-line parser itself accepts.
    pub fn usage(line: impl fmt::Display) -> Self {
        Self { exit_code: 2, ..Self::new(line) }
    }

    /// Creates the failure of a check that found an error in a file.
    pub fn found(path: &Path, error: impl fmt::Display) -> Self {
        Self { exit_code: 3, ..Self::at(path, error) }
    }

    pub fn exit_code(&self) -> u8 {
        self.exit_code
    }

    /// Returns the message with the file and the place in it, where they are known.
    pub fn to_json(&self) -> Value {
        json!({ "message": self.to_string(), "file": self.file, "place": self.place })
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A file name or file contents may bring line ends into the reason.
        f.write_str(&self.line.replace(['\n', '\r'], " "))
    }
}

impl From<IoError> for Failure {
    fn from(error: IoError) -> Self {
        let (file, place) = (Some(files::name(error.path())), error.place());
        Self { file, place, ..Self::new(error) }
    }
}
