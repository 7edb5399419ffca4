//! The run of a verb: what it answers, where it fails, what it says on the way.
//!
//! [`Session`] is what every verb gets. Read on in [`answer`] and [`failure`] for how a verb ends,
//! in [`files`], [`scene_files`] and [`own_files`] for what it reads and writes, and in [`absent`] and
//! [`foreign`] for files that it cannot read.

pub mod absent;
pub mod answer;
pub mod failure;
pub mod files;
pub mod foreign;
pub mod hearing;
pub mod model_file;
pub mod own_files;
pub mod patterns;
pub mod progress;
pub mod report_head;
pub mod scene_files;
pub mod several;

use std::fmt;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use meshlod::Format;
use meshlod::io::{Note, NoteKind};
use serde_json::{Value, json};

use crate::options::args::GlobalArgs;
use crate::options::parse::Suffix;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::progress::Progress;

/// Stack of a thread that does the work of a verb: that of a main thread.
pub const STACK_BYTES: usize = 8 << 20;

/// State of one run of the program.
pub struct Session {
    pub json: bool,
    /// True to print errors only, beside JSON.
    pub quiet: bool,
    /// True if what is left out of a file, or a target that is missed, is a failure.
    pub strict: bool,
    /// Suffix of standard input and output.
    suffix: Option<Suffix>,
    pub progress: Progress,
    /// Start of the program.
    #[cfg_attr(not(feature = "view"), allow(dead_code))]
    pub started: Instant,
    threads: Option<usize>,
    /// Notes on files so far, for the JSON object.
    notes: Mutex<Vec<Value>>,
    /// True once something that was asked for was missed.
    has_missed: AtomicBool,
    /// Warnings so far, where they are kept for somebody else to print.
    kept_warnings: Option<Mutex<Vec<String>>>,
}

impl Session {
    pub fn new(global: GlobalArgs) -> Self {
        let progress = Progress::new(global.quiet);
        Self::with(global, progress)
    }

    fn with(global: GlobalArgs, progress: Progress) -> Self {
        let GlobalArgs { json, strict, quiet, threads, format } = global;
        Self {
            json,
            quiet,
            strict,
            suffix: format,
            progress,
            started: Instant::now(),
            threads,
            notes: Mutex::default(),
            has_missed: AtomicBool::new(false),
            kept_warnings: None,
        }
    }

    /// Creates a session that prints nothing: it shows no progress and keeps warnings.
    pub fn silent(global: GlobalArgs) -> Self {
        Self::heard(global, Progress::hidden())
    }

    /// Creates a session that prints nothing: it keeps warnings, and tells of its progress.
    pub fn heard(global: GlobalArgs, progress: Progress) -> Self {
        Self { kept_warnings: Some(Mutex::default()), ..Self::with(global, progress) }
    }

    /// Takes over options, those of a recipe with those of its run.
    pub fn ask(&mut self, global: GlobalArgs) {
        let GlobalArgs { json, strict, quiet, threads, format } = global;
        if quiet && self.kept_warnings.is_none() {
            self.progress = Progress::new(true);
        }
        (self.json, self.strict, self.quiet, self.threads) = (json, strict, quiet, threads);
        self.suffix = format;
    }

    /// Returns the file format of standard input and output.
    pub fn format(&self) -> Option<Format> {
        self.suffix.as_ref()?.mesh
    }

    /// Fails if standard output would be of a kind that is only read, such as b3dm.
    pub fn check_format(&self) -> Result<(), Failure> {
        let suffix = self.suffix.as_ref().filter(|suffix| Format::is_read_only(&suffix.text));
        suffix.map_or(Ok(()), |Suffix { text, .. }| {
            Err(Failure::usage(format_args!(
                "--format {text}: {text} is read only; use --format glb"
            )))
        })
    }

    /// Does `work` on the number of threads that was asked for, however many other runs in the
    /// process use.
    ///
    /// # Errors
    /// Those of the work, and of a system that has no threads left.
    pub fn on_threads<T: Send>(
        &self,
        work: impl FnOnce() -> Result<T, Failure> + Send,
    ) -> Result<T, Failure> {
        let Some(threads) = self.threads else { return work() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).stack_size(STACK_BYTES);
        let failed = |error| Failure::new(format_args!("--threads: {error}"));
        pool.build().map_err(failed)?.install(work)
    }

    /// Makes all threads of the process that are started later as many as was asked for. If an
    /// earlier run has set their number, that stays.
    pub fn set_threads_of_process(&self) {
        if let Some(threads) = self.threads {
            let _ = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
        }
    }

    /// Prints a warning to standard error, unless `--quiet` was given, or keeps it.
    pub fn warn(&self, line: impl fmt::Display) {
        match &self.kept_warnings {
            Some(kept) => {
                kept.lock().unwrap_or_else(PoisonError::into_inner).push(line.to_string())
            }
            // With `--strict`, a warning of a file may be why the batch fails.
            None if self.quiet && !self.strict => {}
            None => self.progress.suspend(|| say(format_args!("warning: {line}"))),
        }
    }

    /// Says a line while the work goes on: on standard output, or standard error where that is taken
    /// by JSON, and nowhere with `--quiet`.
    pub fn tell(&self, line: &str) {
        if self.quiet || self.kept_warnings.is_some() {
            return;
        }
        // If the stream is closed, nobody is left to tell.
        self.progress.suspend(|| match self.json {
            true => say(line),
            false => {
                let mut out = std::io::stdout();
                let _ = writeln!(out, "{line}").and_then(|()| out.flush());
            }
        });
    }

    /// Warns of a doubt about what is asked for a file, if there is one.
    pub fn doubt(&self, path: &Path, doubt: Option<String>) {
        if let Some(doubt) = doubt {
            self.warn(Failure::at(path, doubt));
        }
    }

    /// Says that something that was asked for was missed: with a warning or, with `--strict`, an
    /// error line, since it is then why the run fails.
    pub fn miss(&self, reason: &Failure) {
        self.has_missed.store(true, Ordering::Relaxed);
        match self.kept_warnings {
            None if self.strict => self.complain(reason),
            _ => self.warn(reason),
        }
    }

    /// Returns the warnings that were kept.
    pub fn take_warnings(&self) -> Vec<String> {
        let kept = self.kept_warnings.as_ref();
        kept.map(|kept| std::mem::take(&mut *kept.lock().unwrap_or_else(PoisonError::into_inner)))
            .unwrap_or_default()
    }

    /// Warns of what was left out or changed on the way from or to a file, with what to do about
    /// it.
    ///
    /// # Errors
    /// With `--strict`, if something was left out.
    pub fn note(&self, path: &Path, notes: &[Note]) -> Result<(), Failure> {
        let notes: Vec<Note> = notes.iter().filter(|note| note.count > 0).cloned().collect();
        let notes = &notes[..];
        for kind in [NoteKind::LeftOut, NoteKind::Changed] {
            let Some(list) = Note::list(notes, kind) else { continue };
            let line = Failure::at(path, format_args!("{}: {list}", kind.word()));
            if self.strict && kind == NoteKind::LeftOut {
                return Err(line);
            }
            self.warn(line);
        }
        let mut all = self.notes.lock().unwrap_or_else(PoisonError::into_inner);
        all.extend(notes.iter().map(|note| note_json(path, note)));
        Ok(())
    }

    /// Completes an answer: with the notes on all files in its JSON, and with the outcome if
    /// something was missed under `--strict`.
    pub fn complete(&self, answer: &mut Answer) {
        let has_missed = self.strict && self.has_missed.load(Ordering::Relaxed);
        if has_missed && answer.outcome == Outcome::Done {
            answer.outcome = Outcome::Missed;
        }
        let notes = std::mem::take(&mut *self.notes.lock().unwrap_or_else(PoisonError::into_inner));
        if let Value::Object(json) = &mut answer.json {
            json.insert("notes".into(), notes.into());
        }
    }

    /// Prints the reason why a command or one of its files failed, unless the session prints
    /// nothing.
    pub fn complain(&self, failure: &Failure) {
        if self.kept_warnings.is_none() {
            self.progress.suspend(|| say(failure));
        }
    }
}

fn note_json(path: &Path, note: &Note) -> Value {
    json!({
        "file": files::name(path),
        "kind": note.kind.word(),
        "count": note.count,
        "what": note.what,
        "names": note.names,
        "remedy": note.remedy,
    })
}

fn say(line: impl fmt::Display) {
    // If standard error is closed, nobody is left to tell.
    let _ = writeln!(std::io::stderr(), "meshlod: {line}");
}
