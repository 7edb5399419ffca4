//! The command `meshlod`: level of detail for triangle meshes, one verb at a time.
//!
//! A verb takes its arguments and the [`Session`] and gives an [`Answer`] or a [`Failure`]; only
//! this file prints answers and decides on exit codes. 0 is done, 1 could not, 2 wrong usage.
#![forbid(unsafe_code)]

mod amounts;
mod answer;
mod args;
mod check;
mod compare;
mod demo;
mod distance;
mod failure;
mod files;
mod fusing;
mod holding;
mod model_file;
mod numbers;
mod page;
mod progress;
mod question;
mod reduce;
mod sequence;
mod session;
mod table;
mod verbs;
mod volume;
mod within;

use std::process::{ExitCode, exit};

use clap::Parser;

use crate::answer::Answer;
use crate::args::Cli;
use crate::failure::Failure;
use crate::session::Session;

/// What shells report of a program that Ctrl-C has ended; said of SIGTERM and SIGHUP too.
const INTERRUPTED: i32 = 130;

fn main() -> ExitCode {
    let cli = Cli::parse();
    // Without a handler signals still end the program; it only might leave a temporary file.
    let _ = ctrlc::set_handler(|| {
        meshlod::io::abandon_files();
        exit(INTERRUPTED);
    });
    let session = Session::new(cli.global);
    let done = answer(cli.verb, &session);
    session.progress.clear();
    match done.and_then(|answer| answer.print(session.json)) {
        Ok(code) => code,
        Err(failure) => {
            session.complain(&failure);
            failure.exit_code()
        }
    }
}

fn answer(verb: args::Verb, session: &Session) -> Result<Answer, Failure> {
    session.start_threads()?;
    verb.run(session)
}
