//! What a verb has to say when it is done.

use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

use serde_json::Value;

use crate::failure::Failure;

/// The outcome of a verb, for programs and for people.
pub struct Answer {
    /// The object that `--json` prints.
    pub json: Value,
    /// What people read: whole lines.
    pub text: String,
    /// Whether standard output holds a mesh or a picture, so that text has to go elsewhere.
    pub file_on_stdout: bool,
    /// Whether the exit code tells of a failure though there is an answer: the user was strict about
    /// a target that was not reached, or a check found errors.
    pub missed: bool,
}

impl Answer {
    pub fn new(json: Value, text: String) -> Self {
        Self { json, text, file_on_stdout: false, missed: false }
    }

    /// Prints itself where it belongs, and gives the exit code.
    ///
    /// A reader that has closed the pipe has seen enough: that is no failure.
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
