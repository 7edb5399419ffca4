//! Progress and remarks of a job, and the wish to cancel it.

use std::fmt;

/// Receiver of what a job says while it runs. Every method has a default: `()` hears nothing.
///
/// A job may call it from any of its threads.
pub trait Watch: Sync {
    /// Called when a stage begins: `measuring`, `building connectivity`.
    fn stage(&self, stage: &str) {
        let _ = stage;
    }

    /// Called when `done` steps of the stage are done; `of` is their number, where it is known.
    fn step(&self, done: usize, of: Option<usize>) {
        let _ = (done, of);
    }

    /// Returns true to end the job at its next step, with
    /// [`JobError::Cancelled`](crate::jobs::JobError::Cancelled).
    fn is_cancelled(&self) -> bool {
        false
    }

    /// Called with what a user should know: something that a request asks for had no effect, or
    /// something of the input is lost.
    fn remark(&self, remark: &Remark) {
        let _ = remark;
    }
}

impl Watch for () {}

/// Something that a user should know, in one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// The thing that the remark is about.
    pub about: About,
    /// The remark, without that thing.
    pub text: String,
}

/// Part of a job that a remark is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum About {
    /// The job as a whole.
    Job,
    /// A field of its request, by its name.
    Field(&'static str),
    /// Its input; of two, the first.
    Input,
    /// The second of two inputs.
    Second,
    /// Its output.
    Output,
}

impl Remark {
    /// Creates a remark about a part of a job.
    pub fn new(about: About, text: impl fmt::Display) -> Self {
        Self { about, text: text.to_string() }
    }

    /// Creates a remark about a field of a request.
    pub fn field(name: &'static str, text: impl fmt::Display) -> Self {
        Self::new(About::Field(name), text)
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.about {
            About::Job => f.write_str(&self.text),
            About::Field(name) => write!(f, "{name}: {}", self.text),
            About::Input => write!(f, "input: {}", self.text),
            About::Second => write!(f, "second input: {}", self.text),
            About::Output => write!(f, "output: {}", self.text),
        }
    }
}
