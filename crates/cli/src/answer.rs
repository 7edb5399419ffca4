//! Result of a command: text for people, JSON for programs, and the exit code.

use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

use serde_json::Value;

use crate::failure::Failure;

/// Result of a command, for programs and for people.
pub struct Answer {
    /// JSON object that is printed with `--json`.
    pub json: Value,
    /// Text that is printed without `--json`, in whole lines.
    pub text: String,
    /// True if standard output carries a mesh or a picture, so that the text goes to standard
    /// error.
    pub file_on_stdout: bool,
    /// True if the exit code must report failure although there is an answer: a target was missed
    /// under `--strict`, or a check found errors.
    pub missed: bool,
}

impl Answer {
    pub fn new(json: Value, text: String) -> Self {
        Self { json, text, file_on_stdout: false, missed: false }
    }

    /// Prints the answer and returns the exit code.
    ///
    /// A closed pipe counts as success: its reader has seen enough.
    pub fn print(&self, json: bool) -> Result<ExitCode, Failure> {
        let written = if json {
            write_all(&mut io::stdout(), &format!("{:#}\n", self.json))
        } else if self.file_on_stdout {
            write_all(&mut io::stderr(), &self.text)
        } else {
            write_all(&mut io::stdout(), &self.text)
        };
        match written {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                Err(Failure::new(format!("standard output: {error}")))
            }
            _ if self.missed => Ok(ExitCode::FAILURE),
            _ => Ok(ExitCode::SUCCESS),
        }
    }
}

fn write_all(out: &mut impl Write, text: &str) -> io::Result<()> {
    out.write_all(text.as_bytes())?;
    out.flush()
}
