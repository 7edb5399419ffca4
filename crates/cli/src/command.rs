//! The command line: global options and one subcommand per verb.

use std::ffi::OsString;

use clap::{CommandFactory, Parser, Subcommand};
use meshlod::Format;

use crate::compare::Compare;
use crate::demo::Demo;
use crate::options::args::GlobalArgs;
use crate::session::Session;
use crate::session::answer::Answer;
use crate::session::failure::Failure;
use crate::verbs::{
    batch, build, check, completions, compress, convert, decompress, extract, flock, info, lods,
    man, measure, page, render, repair, run, sample, serve, simplify, strip, tiles, view,
};

/// Level of detail for triangle meshes.
#[derive(Parser)]
#[command(name = "meshlod", version, max_term_width = 100, long_about = long_about())]
pub struct Cli {
    #[command(flatten)]
    pub global: GlobalArgs,
    #[command(subcommand)]
    pub work: Work,
}

/// Returns the description of the command in its long help.
fn long_about() -> String {
    format!(
        "Level of detail for triangle meshes.\n\nThe suffix selects the format: {}. A path of - means \
         standard input or output, with the format given by --format. Exit codes: 0 done, 1 could \
         not, 2 wrong usage, 3 errors found.",
        Format::suffixes()
    )
}

/// One verb, or several runs of verbs.
#[derive(Subcommand)]
pub enum Work {
    #[command(flatten)]
    Verb(Box<Verb>),
    Batch(batch::Batch),
    Run(run::Run),
}

/// Command line with one verb, as a recipe has it.
#[derive(Parser)]
#[command(name = "meshlod", disable_help_subcommand = true)]
pub struct VerbLine {
    #[command(flatten)]
    pub global: GlobalArgs,
    #[command(subcommand)]
    pub verb: Verb,
}

/// Verb with its arguments; the documentation of each type is the help text of the verb.
#[derive(Subcommand)]
pub enum Verb {
    Info(info::Info),
    Check(check::Check),
    Repair(repair::Repair),
    Simplify(simplify::Simplify),
    Convert(convert::Convert),
    Lods(lods::Lods),
    Build(build::Build),
    Extract(extract::Extract),
    Tiles(tiles::Tiles),
    Strip(strip::Strip),
    Compress(compress::Compress),
    Decompress(decompress::Decompress),
    Compare(Compare),
    Measure(measure::Measure),
    Sample(sample::Sample),
    Render(render::Render),
    View(view::View),
    Serve(serve::Serve),
    Page(page::Page),
    Flock(flock::Flock),
    Demo(Demo),
    Completions(completions::Completions),
    Man(man::Man),
}

impl Verb {
    pub fn run(self, session: &Session) -> Result<Answer, Failure> {
        match self {
            Self::Info(verb) => verb.run(session),
            Self::Check(verb) => verb.run(session),
            Self::Repair(verb) => verb.run(session),
            Self::Simplify(verb) => verb.run(session),
            Self::Convert(verb) => verb.run(session),
            Self::Lods(verb) => verb.run(session),
            Self::Build(verb) => verb.run(session),
            Self::Extract(verb) => verb.run(session),
            Self::Tiles(verb) => verb.run(session),
            Self::Strip(verb) => verb.run(session),
            Self::Compress(verb) => verb.run(session),
            Self::Decompress(verb) => verb.run(session),
            Self::Compare(verb) => verb.run(session),
            Self::Measure(verb) => verb.run(session),
            Self::Sample(verb) => verb.run(session),
            Self::Render(verb) => verb.run(session),
            Self::View(verb) => verb.run(session),
            Self::Serve(verb) => verb.run(session),
            Self::Page(verb) => verb.run(session),
            Self::Flock(verb) => verb.run(session),
            Self::Demo(verb) => verb.run(run_line, session),
            Self::Completions(verb) => verb.run(Cli::command()),
            Self::Man(verb) => verb.run(Cli::command(), session),
        }
    }
}

/// Runs a verb with its arguments, the first of which is the name of the program.
fn run_line(line: Vec<OsString>, session: &Session) -> Result<Answer, Failure> {
    VerbLine::try_parse_from(line).map_err(Failure::new)?.verb.run(session)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }
}
