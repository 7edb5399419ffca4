//! `batch`: the arguments of many runs of one verb. What is done is in `crate::batch`.

use std::path::PathBuf;

use clap::{ArgMatches, Args, Command, FromArgMatches};

use crate::options::parse;
use crate::recipe::{Recipe, Spelled, VerbOptions};
use crate::session::failure::Failure;
use crate::verbs::simplify::Simplify;

/// Simplify many files, or run a recipe on them
///
/// Files that were made before by the same recipe are skipped, so that a batch that was interrupted
/// goes on. A file that fails does not stop the others; the exit code is 1 then.
#[derive(Args)]
pub struct Batch {
    /// Files, folders, and patterns such as 'in/**/*.glb'
    ///
    /// Put patterns in quotes: ** stands for any folders. Below the fixed part of a pattern, OUT
    /// gets the same folders.
    #[arg(value_name = "IN", required = true)]
    pub inputs: Vec<PathBuf>,
    /// Folder to write to
    #[arg(value_name = "OUT", required = true)]
    pub output: PathBuf,
    /// Recipe to use in place of the options of simplify
    ///
    /// For a verb with IN and OUT: a .toml or .json file as for the verb run, or its JSON itself,
    /// in braces.
    #[arg(long, value_name = "FILE")]
    recipe: Option<PathBuf>,
    /// Number of files at a time [default: one per core]
    ///
    /// Each works on cores / N threads unless --threads is given.
    #[arg(long, value_name = "N", value_parser = parse::threads, allow_negative_numbers = true)]
    pub jobs: Option<usize>,
    /// Write a table of all files: .csv or .json
    ///
    /// It has their faces, errors, times and warnings.
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Make files again that are there already
    #[arg(long)]
    pub force: bool,
    /// Only list what would be done
    #[arg(long)]
    pub dry_run: bool,
    #[command(flatten)]
    options: SimplifyOptions,
}

impl Batch {
    /// Returns the recipe that is given as a file or by options.
    pub fn recipe(&self) -> Result<Recipe, Failure> {
        match (&self.recipe, self.options.0.first()) {
            (Some(path), None) => Recipe::read(path),
            (Some(_), Some(option)) => Err(Failure::usage(format_args!(
                "--{}: give options of simplify or --recipe, not both",
                option.name
            ))),
            (None, _) => Ok(Recipe::of_options(SIMPLIFY, self.options.0.clone())),
        }
    }
}

const SIMPLIFY: &str = "simplify";

/// Options of `simplify` as they were given; the parser judges them again for each file.
struct SimplifyOptions(Vec<Spelled>);

impl Args for SimplifyOptions {
    fn augment_args(command: Command) -> Command {
        let simplify = Simplify::augment_args(Command::new(SIMPLIFY));
        let options = simplify.get_arguments().filter(|arg| !arg.is_positional()).cloned();
        // A recipe may stand in for the target.
        let groups = simplify.get_groups().cloned().map(|group| group.required(false));
        let own: Vec<_> = groups.filter(|group| group.get_id() == "TargetArgs").collect();
        command.args(options.collect::<Vec<_>>()).groups(own)
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for SimplifyOptions {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given = VerbOptions::named(SIMPLIFY).map(|verb| verb.given(matches));
        Ok(Self(given.unwrap_or_default()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
