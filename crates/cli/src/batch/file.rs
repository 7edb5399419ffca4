//! One file of a batch: a run of the verb, and how it went.

use std::any::Any;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Instant, UNIX_EPOCH};

use crate::batch::plan::FileJob;
use crate::batch::report::{FileReport, Status};
use crate::command::VerbLine;
use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;

/// Size of a file, and when it was changed, by which it is known again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileState {
    pub bytes: u64,
    /// Time of the last change, in nanoseconds since 1970.
    pub changed_ns: u64,
}

impl FileState {
    /// Returns the state of a file, if it is there.
    pub fn of(path: &Path) -> Option<Self> {
        let found = fs::metadata(path).ok().filter(fs::Metadata::is_file)?;
        let changed = found.modified().ok()?.duration_since(UNIX_EPOCH).ok()?;
        Some(Self { bytes: found.len(), changed_ns: changed.as_nanos().try_into().ok()? })
    }
}

/// Makes the output of one file. A panic, which would be a defect, is a failure of this file alone.
pub fn run_file(line: Result<VerbLine, Failure>, job: &FileJob) -> FileReport {
    let start = Instant::now();
    let mut report = FileReport::planned(job);
    report.set_input(FileState::of(&job.input));
    let done = catch_unwind(AssertUnwindSafe(|| attempt(line, job, &mut report)));
    match done.unwrap_or_else(|panic| Err(defect(&*panic))) {
        Ok(answer) => {
            report.status = match answer.outcome {
                Outcome::Done => Status::Done,
                Outcome::Missed | Outcome::Found => Status::Missed,
            };
            report.set_output(FileState::of(&job.output));
            report.result = Some(answer.json);
        }
        Err(failure) => {
            report.status = Status::Failed;
            report.error = Some(failure.to_string());
        }
    }
    report.seconds = start.elapsed().as_secs_f64();
    report
}

fn attempt(
    line: Result<VerbLine, Failure>,
    job: &FileJob,
    report: &mut FileReport,
) -> Result<Answer, Failure> {
    let line = line?;
    if let Some(folder) = job.output.parent() {
        fs::create_dir_all(folder).map_err(|error| Failure::at(folder, error))?;
    }
    let session = Session::silent(line.global);
    let done = line.verb.run(&session);
    report.warnings = session.take_warnings();
    let mut answer = done?;
    session.complete(&mut answer);
    Ok(answer)
}

fn defect(panic: &(dyn Any + Send)) -> Failure {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("no message");
    Failure::new(format_args!("meshlod has a defect: {text}; please report it with the input"))
}
