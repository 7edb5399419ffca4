//! A session that hears a job: its stages, its steps and its remarks.

use std::error::Error;
use std::path::Path;

use meshlod::IoError;
use meshlod::jobs::{About, JobError, Remark, Watch};

use crate::session::Session;
use crate::session::failure::Failure;

/// A session that hears a job about one file, or two that it compares.
pub struct Hearing<'s> {
    session: &'s Session,
    input: &'s Path,
    second: &'s Path,
    output: &'s Path,
}

impl<'s> Hearing<'s> {
    /// Creates the watch of a job that works on `input` for `output`, which may be the same.
    pub fn new(session: &'s Session, input: &'s Path, output: &'s Path) -> Self {
        Self { session, input, second: input, output }
    }

    /// Creates the watch of a job that compares two files.
    pub fn of_two(session: &'s Session, first: &'s Path, second: &'s Path) -> Self {
        Self { session, input: first, second, output: first }
    }

    /// Names the file or option that an error of the job is about.
    pub fn failure(&self, error: JobError) -> Failure {
        match error {
            JobError::Request { field: "", reason } => Failure::usage(reason),
            JobError::Request { field, reason } => {
                Failure::usage(format_args!("{}: {reason}", option(field)))
            }
            JobError::Input(error) => at(self.input, error),
            JobError::Second(error) => at(self.second, error),
            JobError::Output(error) => at(self.output, error),
            error => Failure::new(error),
        }
    }
}

impl Watch for Hearing<'_> {
    fn stage(&self, stage: &str) {
        self.session.progress.stage(stage);
    }

    fn step(&self, done: usize, of: Option<usize>) {
        self.session.progress.step(done, of);
    }

    fn remark(&self, Remark { about, text }: &Remark) {
        match about {
            About::Field(name) => {
                self.session.miss(&Failure::new(format_args!("{}: {text}", option(name))));
            }
            About::Input => self.session.warn(Failure::at(self.input, text)),
            About::Second => self.session.warn(Failure::at(self.second, text)),
            About::Output => self.session.warn(Failure::at(self.output, text)),
            _ => self.session.warn(text),
        }
    }
}

/// Creates the failure of an error at a file, unless the error names one itself.
fn at(path: &Path, error: Box<dyn Error + Send + Sync>) -> Failure {
    match error.downcast::<IoError>() {
        Ok(error) => Failure::from(*error),
        Err(error) => Failure::at(path, error),
    }
}

/// Spells a field of a request as the option that sets it: `exact_volume` as `--exact-volume`.
fn option(field: &str) -> String {
    format!("--{}", field.replace('_', "-"))
}
