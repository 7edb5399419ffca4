//! What all verbs share: how to talk to the user, and the threads.

use std::fmt;
use std::io::Write;

use meshlod::Format;

use crate::args::Global;
use crate::failure::Failure;
use crate::progress::Progress;

/// One run of the program.
pub struct Session {
    pub json: bool,
    /// The format of `-`.
    pub format: Option<Format>,
    pub progress: Progress,
    threads: Option<usize>,
}

impl Session {
    pub fn new(global: Global) -> Self {
        let Global { json, threads, format } = global;
        Self { json, format, progress: Progress::new(), threads }
    }

    pub fn start_threads(&self) -> Result<(), Failure> {
        let Some(threads) = self.threads else { return Ok(()) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build_global().map_err(|error| Failure::new(format_args!("--threads: {error}")))
    }

    /// Tells the user something that does not stop the work.
    pub fn warn(&self, line: impl fmt::Display) {
        self.progress.suspend(|| say(format_args!("warning: {line}")));
    }

    /// Tells the user why the work stopped.
    pub fn complain(&self, failure: &Failure) {
        say(failure);
    }
}

fn say(line: impl fmt::Display) {
    // With standard error closed there is nobody left to tell.
    let _ = writeln!(std::io::stderr(), "meshlod: {line}");
}
