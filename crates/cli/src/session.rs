//! State shared by all commands: output format, messages and threads.

use std::fmt;
use std::io::Write;
use std::time::Instant;

use meshlod::Format;

use crate::args::GlobalArgs;
use crate::failure::Failure;
use crate::progress::Progress;

/// State of one run of the program.
pub struct Session {
    pub json: bool,
    /// File format of standard input and output.
    pub format: Option<Format>,
    pub progress: Progress,
    /// Start of the program.
    #[cfg_attr(not(feature = "view"), allow(dead_code))]
    pub started: Instant,
    threads: Option<usize>,
}

impl Session {
    pub fn new(global: GlobalArgs) -> Self {
        let GlobalArgs { json, threads, format } = global;
        Self { json, format, progress: Progress::new(), started: Instant::now(), threads }
    }

    pub fn start_threads(&self) -> Result<(), Failure> {
        let Some(threads) = self.threads else { return Ok(()) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build_global().map_err(|error| Failure::new(format_args!("--threads: {error}")))
    }

    /// Prints a warning to standard error.
    pub fn warn(&self, line: impl fmt::Display) {
        self.progress.suspend(|| say(format_args!("warning: {line}")));
    }

    /// Prints the reason why a command failed.
    pub fn complain(&self, failure: &Failure) {
        say(failure);
    }
}

fn say(line: impl fmt::Display) {
    // If standard error is closed, nobody is left to tell.
    let _ = writeln!(std::io::stderr(), "meshlod: {line}");
}
