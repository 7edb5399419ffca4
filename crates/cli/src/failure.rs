//! Failure of a command: one line of text and an exit code.

use std::fmt;
use std::path::Path;
use std::process::ExitCode;

use meshlod::IoError;

use crate::files;

/// Reason why a command failed, as one line: `FILE: place: reason`.
#[derive(Debug)]
pub struct Failure {
    line: String,
    wrong_usage: bool,
}

impl Failure {
    pub fn new(line: impl fmt::Display) -> Self {
        Self { line: line.to_string(), wrong_usage: false }
    }

    /// Creates a failure that begins with a file name.
    pub fn at(path: &Path, reason: impl fmt::Display) -> Self {
        Self::new(format_args!("{}: {reason}", files::name(path)))
    }

    /// Creates a usage error, for arguments that the command-line parser itself accepts.
    pub fn usage(line: impl fmt::Display) -> Self {
        Self { wrong_usage: true, ..Self::new(line) }
    }

    pub fn exit_code(&self) -> ExitCode {
        if self.wrong_usage { ExitCode::from(2) } else { ExitCode::FAILURE }
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
        Self::new(error)
    }
}
