//! Recipes: a verb with its options, as a TOML or JSON file, or from the command line.
//!
//! A recipe becomes arguments for the command-line parser, which alone knows options and judges
//! their values. What it says of an option gets the line of the recipe.

mod spell;
mod text;

use std::ffi::OsString;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, Parser};

use crate::command::VerbLine;
pub use crate::recipe::spell::{Spelled, VerbOptions};
pub use crate::recipe::text::Syntax;
use crate::recipe::text::{Fault, entries};
use crate::session::failure::Failure;
use crate::session::files;
use crate::usage::{explain, one_line};

/// Largest file that is read as a recipe.
const MAX_BYTES: u64 = 1 << 16;
/// Options that decide about no byte of an output.
const OF_THE_RUN: [&str; 4] = ["json", "quiet", "threads", "strict"];

/// Verb with options, ready for the command-line parser.
#[derive(Clone, Debug)]
pub struct Recipe {
    pub verb: String,
    /// Options, in the order of their names.
    pub options: Vec<Spelled>,
    /// Values of positional arguments, by their places.
    pub places: Vec<Option<OsString>>,
    source: Source,
}

/// Origin of a recipe, for messages.
#[derive(Clone, Debug)]
enum Source {
    CommandLine,
    /// A file, with the lines of its keys.
    File {
        path: PathBuf,
        lines: Vec<(String, usize)>,
    },
}

impl Recipe {
    /// Reads a recipe; the suffix of the file decides about its syntax. What begins with a brace is
    /// itself a recipe, in JSON, with paths relative to the current folder.
    ///
    /// # Errors
    /// Of the system, of the syntax, and keys that the verb does not have, with their lines.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        if let Some(text) = path.to_str().filter(|text| text.trim_start().starts_with('{')) {
            return Self::parse(text, Syntax::Json, Path::new("recipe"));
        }
        let suffix = path.extension().unwrap_or_default().to_ascii_lowercase();
        let syntax = match suffix.to_str() {
            Some("toml") => Syntax::Toml,
            Some("json") => Syntax::Json,
            _ => return Err(no_recipe(path)),
        };
        let mut text = String::new();
        File::open(path)
            .and_then(|file| file.take(MAX_BYTES + 1).read_to_string(&mut text))
            .map_err(|error| Failure::at(path, error))?;
        if text.len() as u64 > MAX_BYTES {
            return Err(Failure::at(path, "is larger than 64 KiB: not a recipe"));
        }
        Self::parse(&text, syntax, path)
    }

    /// Parses a recipe, whose paths are relative to the folder of `path`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(text: &str, syntax: Syntax, path: &Path) -> Result<Self, Failure> {
        let wrong = |fault: Fault| Failure::at(path, fault);
        let mut entries = entries(text, syntax).map_err(wrong)?;
        let verb = entries.iter().position(|entry| entry.key == "verb");
        let verb = verb.map(|at| entries.remove(at));
        let verb = verb.ok_or_else(|| Failure::at(path, "verb is missing: verb = \"simplify\""))?;
        let known = VerbOptions::of(&verb.value)
            .map_err(|reason| wrong(Fault { line: verb.line, reason }))?;
        let mut recipe = Self {
            verb: known.verb.clone(),
            options: Vec::new(),
            places: vec![None; known.places()],
            source: Source::CommandLine,
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        for entry in &entries {
            known
                .add(entry, folder, &mut recipe)
                .map_err(|reason| wrong(Fault { line: entry.line, reason }))?;
        }
        // Stable: values of one option keep their order.
        recipe.options.sort_by(|a, b| a.name.cmp(&b.name));
        let lines = entries.into_iter().map(|entry| (entry.key, entry.line)).collect();
        recipe.source = Source::File { path: path.to_owned(), lines };
        Ok(recipe)
    }

    /// Makes a recipe of options that the command-line parser has accepted.
    pub fn of_options(verb: &str, mut options: Vec<Spelled>) -> Self {
        options.sort_by(|a, b| a.name.cmp(&b.name));
        Self { verb: verb.into(), options, places: Vec::new(), source: Source::CommandLine }
    }

    /// Has the command-line parser read the recipe, with these paths in place of its own.
    ///
    /// # Errors
    /// What the parser says, in one line.
    pub fn line(&self, paths: &[PathBuf]) -> Result<VerbLine, Failure> {
        let arguments = self.arguments(paths);
        VerbLine::try_parse_from(&arguments)
            .map_err(|error| self.failure(&explain(error, &arguments, VerbLine::command())))
    }

    /// Returns the recipe as arguments, beginning with the name of the program, with these
    /// paths in place of its own.
    pub fn arguments(&self, paths: &[PathBuf]) -> Vec<OsString> {
        let all = self.places.len().max(paths.len());
        let place = |at: usize| match paths.get(at) {
            Some(path) => Some(path.as_os_str()),
            None => self.places.get(at)?.as_deref(),
        };
        let mut arguments = self.bare_arguments();
        arguments.extend((0..all).map_while(place).map(OsString::from));
        arguments
    }

    /// Returns the recipe as arguments without paths, which may follow.
    pub fn bare_arguments(&self) -> Vec<OsString> {
        let mut arguments: Vec<OsString> = vec!["meshlod".into(), self.verb.clone().into()];
        arguments.extend(self.options.iter().map(Spelled::argument));
        arguments.push("--".into());
        arguments
    }

    /// Reports whether the verb reads one file and writes another.
    pub fn reads_and_writes(&self) -> bool {
        VerbOptions::named(&self.verb).is_some_and(|verb| verb.reads_and_writes())
    }

    /// Describes everything that decides about the bytes of an output, in one line.
    pub fn fingerprint(&self) -> String {
        let decides = |option: &&Spelled| !OF_THE_RUN.contains(&&*option.name);
        let options = self.options.iter().filter(decides).map(|option| option.fingerprint());
        let all: Vec<String> = std::iter::once(self.verb.clone()).chain(options).collect();
        format!("meshlod {} {}", env!("CARGO_PKG_VERSION"), all.join(" "))
    }

    fn failure(&self, error: &clap::Error) -> Failure {
        let reason = one_line(error);
        let Source::File { path, lines } = &self.source else { return Failure::usage(reason) };
        let key = match error.get(ContextKind::InvalidArg) {
            Some(ContextValue::String(name)) => {
                name.trim_start_matches('-').split([' ', '=']).next()
            }
            _ => None,
        };
        match lines.iter().find(|(known, _)| Some(known.as_str()) == key) {
            Some((_, line)) => Failure::at(path, Fault { line: *line, reason }),
            None => Failure::at(path, reason),
        }
    }

    /// Returns the name of the file, or of the verb if there is none, for messages.
    pub fn name(&self) -> String {
        match &self.source {
            Source::CommandLine => self.verb.clone(),
            Source::File { path, .. } => files::name(path),
        }
    }
}

/// Makes the failure of a path without the suffix of a recipe.
fn no_recipe(path: &Path) -> Failure {
    let name = files::name(path);
    match VerbOptions::named(&name) {
        Some(_) => {
            let reason =
                "is a verb, and a recipe is a .toml or .json file; a verb is run by itself";
            Failure::at(path, format_args!("{reason}: meshlod {name}"))
        }
        None => Failure::at(path, "a recipe must end in .toml or .json"),
    }
}
