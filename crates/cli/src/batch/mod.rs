//! Many files, one recipe: what `meshlod batch` does.
//!
//! 1. `plan.rs` finds the files and chooses a place for each output; names that collide are refused
//!    before anything is done.
//! 2. `journal.rs` knows which outputs are there already, by the same recipe and of the same input.
//! 3. `workers.rs` does the others on threads, `file.rs` one of them.
//! 4. `report.rs` tells how each went.

mod file;
mod journal;
mod plan;
mod report;
mod workers;

use std::ffi::OsString;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;

use clap::Parser;
use meshlod::io::{remove_abandoned, write_file};
use serde_json::json;

use crate::batch::journal::Journal;
use crate::batch::plan::{FileJob, Plan};
use crate::batch::report::{FileReport, Status, table};
use crate::batch::workers::{Crew, run_jobs};
use crate::command::VerbLine;
use crate::options::args::GlobalArgs;
use crate::recipe::Recipe;
use crate::session::Session;
use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::files;
use crate::text::numbers::{count, plural, value};
use crate::usage::one_line;
use crate::verbs::batch::Batch;

/// Does what the verb `batch` asks for.
///
/// # Errors
/// Whatever is wrong before the first file is begun; failures of single files are in the answer.
pub fn run(batch: &Batch, global: GlobalArgs, session: &Session) -> Result<Answer, Failure> {
    let start = Instant::now();
    let recipe = batch.recipe()?;
    let global = global.or(check(&recipe)?.global);
    batch.report.as_deref().map_or(Ok(()), check_report)?;
    session.progress.stage("looking for files");
    let plan = Plan::new(&batch.inputs, &batch.output, global.format.as_ref())?;
    // What passes without may not pass with it.
    let strictly = if global.strict { " --strict" } else { "" };
    let fingerprint = recipe.fingerprint() + strictly;
    let mut journal = Journal::read(&batch.output)?;
    let known = |job: &FileJob| match batch.force {
        true => None,
        false => journal.made(job, &fingerprint),
    };
    let mut reports: Vec<FileReport> = plan
        .jobs
        .iter()
        .map(|job| known(job).unwrap_or_else(|| FileReport::planned(job)))
        .collect();
    if !batch.dry_run {
        files::make_folder(&batch.output)?;
        let todo: Vec<usize> =
            (0..reports.len()).filter(|&at| reports[at].status == Status::Planned).collect();
        let skipped = reports.len() - todo.len();
        let jobs: Vec<&FileJob> = todo.iter().map(|&at| &plan.jobs[at]).collect();
        let (mut done, mut unkept) = (skipped, None);
        // Zero sets up the line, also where an earlier run has made some.
        session.progress.part("files", 0, reports.len());
        session.progress.part("files", done, reports.len());
        remove_abandoned(jobs.iter().map(|job| &*job.output));
        let crew = Crew::new(batch.jobs, jobs.len(), &global);
        run_jobs(&jobs, &recipe, &crew, &mut |at, report| {
            tell(&report, session);
            if let Err(failure) = journal.add(&report, &fingerprint) {
                unkept = Some(failure);
            }
            reports[todo[at]] = report;
            done += 1;
            session.progress.part("files", done, plan.jobs.len());
        })?;
        if let Some(failure) = unkept {
            session.warn(format_args!("files will be made again by the next run: {failure}"));
        }
    }
    if let Some(path) = &batch.report {
        write_file(path, table(&reports, is_json(path)).as_bytes())?;
    }
    let seconds = start.elapsed().as_secs_f64();
    Ok(answer(batch, (&recipe, &fingerprint), &plan, &reports, seconds))
}

/// Refuses recipes that cannot be run for many files, and those that the parser refuses.
fn check(recipe: &Recipe) -> Result<VerbLine, Failure> {
    if !recipe.reads_and_writes() {
        let reason = "batch takes verbs with IN and OUT, such as simplify";
        return Err(Failure::new(format_args!("{}: {reason}", recipe.name())));
    }
    recipe.line(&["in".into(), "out".into()])
}

fn check_report(path: &Path) -> Result<(), Failure> {
    match path.extension() {
        Some(suffix) if suffix.eq_ignore_ascii_case("csv") || is_json(path) => {
            files::check_place(path)
        }
        _ => Err(Failure::usage(format_args!(
            "{}: a report must end in .csv or .json",
            files::name(path)
        ))),
    }
}

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("json"))
}

/// Prints the warnings of a file and the reason why it failed.
fn tell(report: &FileReport, session: &Session) {
    for warning in &report.warnings {
        session.warn(report.placed(warning));
    }
    if let Some(error) = &report.error {
        session.complain(&Failure::new(report.placed(error)));
    }
}

fn answer(
    batch: &Batch,
    (recipe, fingerprint): (&Recipe, &str),
    plan: &Plan,
    reports: &[FileReport],
    seconds: f64,
) -> Answer {
    let number = |status| reports.iter().filter(|report| report.status == status).count();
    let mut text = format!(
        "{}: {} file{}",
        files::name(&batch.output),
        count(reports.len()),
        plural(reports.len())
    );
    let mut json = json!({
        "file": files::name(&batch.output),
        "recipe": fingerprint,
        "files": reports.len(),
        "other_files": plan.others,
        "seconds": seconds,
    });
    for status in Status::ALL {
        let files = number(status);
        json[status.name()] = files.into();
        if files > 0 {
            let _ = write!(text, ", {} {}", count(files), status.words());
        }
    }
    let _ = writeln!(text, " in {} s", value(seconds));
    if plan.others > 0 {
        let files = plural(plan.others);
        let _ =
            writeln!(text, "{} other file{files}, of no format that is read", count(plan.others));
    }
    if batch.dry_run {
        let arguments = recipe.bare_arguments();
        json["arguments"] = arguments.iter().map(|word| word.to_string_lossy()).collect();
        for report in reports.iter().filter(|report| report.status == Status::Planned) {
            let _ = writeln!(text, "{} -> {}", report.input, report.output);
        }
    }
    json["reports"] = json!(reports);
    let wrong = number(Status::Failed) + number(Status::Missed) > 0;
    Answer { outcome: Outcome::Missed.when(wrong), ..Answer::new(json, text) }
}

/// Does one file of a batch, as a worker elsewhere does, and returns its report as JSON. `arguments`
/// are those of a dry run, without paths; the file gets one thread unless they say otherwise.
pub fn run_file_json(mut arguments: Vec<OsString>, input: &Path, output: &Path) -> String {
    let job = FileJob { input: input.into(), output: output.into() };
    arguments.extend([input.as_os_str().to_owned(), output.as_os_str().to_owned()]);
    let line = VerbLine::try_parse_from(arguments);
    let line = line.map_err(|error| Failure::usage(one_line(&error)));
    let threads = line.as_ref().ok().and_then(|line| line.global.threads).unwrap_or(1);
    let report = match workers::pool(threads) {
        Ok(pool) => pool.install(|| file::run_file(line, &job)),
        Err(failure) => file::run_file(Err(failure), &job),
    };
    json!(report).to_string()
}

/// Notes in the journal of `folder` that a worker elsewhere has made a file, given its report.
///
/// # Errors
/// Of the system.
pub fn record_json(folder: &Path, recipe: &str, report: &str) -> Result<(), Failure> {
    let wrong = |error| Failure::new(format_args!("this is not the report of a file: {error}"));
    let report: FileReport = serde_json::from_str(report).map_err(wrong)?;
    Journal::new(folder).add(&report, recipe)
}
