//! Result of a command: text for people, JSON for programs, and the exit code.

use std::io::{self, ErrorKind, Write};

use serde::Serialize;
use serde_json::{Value, json};

use crate::session::Session;
use crate::session::failure::Failure;

/// Outcome of a command that has an answer; it sets the exit code.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outcome {
    /// Done as asked: 0.
    #[default]
    Done,
    /// A target was missed under `--strict`, or nothing could be shown: 1.
    Missed,
    /// A check found errors, or strips draw something else than their level: 3.
    Found,
}

impl Outcome {
    /// Returns `self` if a condition holds, else [`Outcome::Done`].
    pub fn when(self, condition: bool) -> Self {
        if condition { self } else { Self::Done }
    }

    fn exit_code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Missed => 1,
            Self::Found => 3,
        }
    }
}

/// Result of a command, for programs and for people.
pub struct Answer {
    /// JSON object that is printed with `--json`.
    pub json: Value,
    /// Text that is printed without `--json`, in whole lines.
    pub text: String,
    /// True if standard output carries a mesh or a picture, so that the text goes to standard
    /// error.
    pub file_on_stdout: bool,
    /// True if the text is the output itself, which `--quiet` leaves.
    pub is_output: bool,
    /// Outcome, which sets the exit code.
    pub outcome: Outcome,
}

impl Answer {
    /// Creates an answer; `json` must be a structure or a map, which are objects in JSON.
    pub fn new(json: impl Serialize, text: String) -> Self {
        Self {
            json: json!(json),
            text,
            file_on_stdout: false,
            is_output: false,
            outcome: Outcome::Done,
        }
    }

    /// Prints the answer, of `--quiet` only JSON, and returns the exit code.
    ///
    /// A closed pipe counts as success: its reader has seen enough.
    pub fn print(&self, session: &Session) -> Result<u8, Failure> {
        let written = if session.json {
            write_json(&self.json)
        } else if session.quiet && !self.is_output {
            Ok(())
        } else if self.file_on_stdout {
            write_all(&mut io::stderr(), &self.text)
        } else {
            write_all(&mut io::stdout(), &self.text)
        };
        match written {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                Err(Failure::new(format!("standard output: {error}")))
            }
            _ => Ok(self.outcome.exit_code()),
        }
    }
}

/// Prints a JSON object to standard output. If that is closed, nobody is left to tell.
pub fn print_json(json: &Value) {
    let _ = write_json(json);
}

fn write_json(json: &Value) -> io::Result<()> {
    write_all(&mut io::stdout(), &format!("{json:#}\n"))
}

fn write_all(out: &mut impl Write, text: &str) -> io::Result<()> {
    out.write_all(text.as_bytes())?;
    out.flush()
}
