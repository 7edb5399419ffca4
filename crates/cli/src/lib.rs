//! The command `meshlod`: level of detail for triangle meshes, one verb at a time.
//!
//! A verb takes its arguments and the `Session` and returns an `Answer` or a `Failure`; only
//! this file prints answers and sets exit codes: 0 for success, 1 for failure, 2 for wrong usage, 3
//! for findings. Programs and the Python package call [`run`].
#![forbid(unsafe_code)]

mod batch;
mod browser;
mod check;
mod command;
mod compare;
mod demo;
mod flock;
mod options;
mod page;
mod recipe;
mod session;
mod text;
mod usage;
mod verbs;
mod view;

use std::ffi::OsString;
use std::path::Path;
use std::process::exit;

use clap::{CommandFactory, FromArgMatches};

use crate::command::{Cli, Verb, Work};
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::session::progress::Progress;

/// Exit code that shells report for Ctrl-C; also used for SIGTERM and SIGHUP.
const INTERRUPTED: i32 = 130;

/// Runs the command with these arguments, the first of which is the name of the program, and returns
/// the exit code.
///
/// Output goes to the standard streams of the process. Wrong usage and `--help` print their text and
/// are returned as exit codes, too. Signals are left alone; see [`end_at_signals`].
pub fn run<A: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> u8 {
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let (mut verb, cli) = match parse(&arguments) {
        Ok(parsed) => parsed,
        Err(wrong) => return refuse(&wrong, arguments.iter().any(|argument| argument == "--json")),
    };
    let mut session = Session::new(cli.global.clone());
    let done = perform(&mut verb, cli, &mut session);
    session.progress.clear();
    match done.and_then(|answer| answer.print(&session)) {
        Ok(code) => code,
        Err(failure) => {
            session.complain(&failure);
            if session.json {
                session::answer::print_json(&session::report_head::of_failure(
                    Some(&verb),
                    &failure,
                ));
            }
            failure.exit_code()
        }
    }
}

/// Parses the arguments, and returns the name of the verb with them.
fn parse(arguments: &[OsString]) -> Result<(String, Cli), clap::Error> {
    let mut command = Cli::command();
    let matches = command
        .try_get_matches_from_mut(arguments)
        .map_err(|error| usage::explain(error, arguments, Cli::command()))?;
    let verb = matches.subcommand_name().unwrap_or_default().to_owned();
    let cli = Cli::from_arg_matches(&matches).map_err(|error| error.format(&mut command))?;
    Ok((verb, cli))
}

/// Prints wrong usage, or the help or version that was asked for, and returns the exit code.
fn refuse(wrong: &clap::Error, json: bool) -> u8 {
    // If the stream is closed, nobody is left to tell.
    let _ = wrong.print();
    if json && wrong.use_stderr() {
        let failure = Failure::usage(usage::one_line(wrong));
        session::answer::print_json(&session::report_head::of_failure(None, &failure));
    }
    u8::try_from(wrong.exit_code()).unwrap_or(2)
}

/// Runs the command with these arguments as [`run`] does, but prints nothing, and returns the JSON
/// that `--json` prints.
///
/// `listener` is told how many files of a batch, or parts of other work, are done, and of how many.
///
/// # Errors
/// The line that [`run`] prints, of failures and wrong usage.
pub fn answer_of<A: Into<OsString> + Clone>(
    arguments: impl IntoIterator<Item = A>,
    listener: impl Fn(usize, usize) + Send + Sync + 'static,
) -> Result<String, String> {
    let arguments: Vec<OsString> = arguments.into_iter().map(Into::into).collect();
    let (mut verb, cli) = parse(&arguments).map_err(|wrong| usage::one_line(&wrong))?;
    let progress = Progress::told(Box::new(listener));
    let mut session = Session::heard(cli.global.clone(), progress);
    let done = perform(&mut verb, cli, &mut session).map_err(|failure| failure.to_string())?;
    Ok(done.json.to_string())
}

/// Does one file of a batch and returns its report as JSON, for workers in other processes.
///
/// `arguments` are the `arguments` of a dry run (`meshlod batch … --dry-run --json`), `input` and
/// `output` those of one of its files. The output is written whole or not at all; a failure is told
/// by the report.
pub fn run_file_of_batch(arguments: Vec<OsString>, input: &Path, output: &Path) -> String {
    batch::run_file_json(arguments, input, output)
}

/// Notes that a file of a batch was made elsewhere, so that later batches skip it.
///
/// `folder` is the output folder, `recipe` that of the dry run, `report` what
/// [`run_file_of_batch`] returned; reports of failures are ignored.
///
/// # Errors
/// One line, if the journal in the folder cannot be written.
pub fn record_file_of_batch(folder: &Path, recipe: &str, report: &str) -> Result<(), String> {
    batch::record_json(folder, recipe, report).map_err(|failure| failure.to_string())
}

/// Makes Ctrl-C, SIGTERM and SIGHUP end the process with exit code 130, without temporary files.
///
/// For processes that do nothing else: no destructor runs. Where a handler is set already, it stays.
pub fn end_at_signals() {
    // Without a handler, signals still end the program but may leave a temporary file.
    let _ = ctrlc::set_handler(|| {
        // A server is ended by Ctrl-C, and then says what it has done.
        if verbs::serve::end() {
            return;
        }
        meshlod::io::abandon_files();
        exit(INTERRUPTED);
    });
}

/// Does the work; `name` becomes that of the verb that a recipe names.
fn perform(name: &mut String, cli: Cli, session: &mut Session) -> Result<Answer, Failure> {
    let mut answer = match cli.work {
        Work::Verb(verb) => answer(*verb, session)?,
        Work::Batch(batch) => batch::run(&batch, cli.global, session)?,
        Work::Run(run) => {
            let recipe = run.recipe()?;
            let line = recipe.line(&run.paths)?;
            *name = recipe.verb;
            session.ask(cli.global.or(line.global));
            answer(line.verb, session)?
        }
    };
    answer.json = session::report_head::with_head(name, answer.json);
    Ok(answer)
}

fn answer(verb: Verb, session: &Session) -> Result<Answer, Failure> {
    let mut answer = match verb {
        // Windows belong to the main thread.
        Verb::View(_) => {
            session.set_threads_of_process();
            verb.run(session)?
        }
        verb => session.on_threads(|| verb.run(session))?,
    };
    session.complete(&mut answer);
    Ok(answer)
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[test]
    fn every_run_in_a_process_has_its_own_threads() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("torus.ply");
        for threads in ["2", "3"] {
            let arguments = ["meshlod", "sample", "torus", path.to_str().unwrap()];
            assert_eq!(run([&arguments[..], &["--threads", threads]].concat()), 0, "{threads}");
        }
        let session = |threads: usize| {
            let threads = threads.to_string();
            let line = ["meshlod", "--threads", &threads, "sample", "torus", "-"];
            Session::new(Cli::try_parse_from(line).unwrap().global)
        };
        for threads in [3, 1] {
            let found = session(threads).on_threads(|| Ok(rayon::current_num_threads()));
            assert_eq!(found.unwrap_or_default(), threads);
        }
    }
}
