//! Keys of a recipe as arguments of the command line, by what the parser knows of a verb.

use std::any::TypeId;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use clap::{Arg, ArgAction, ArgMatches, Command, CommandFactory, Parser};

use crate::command::VerbLine;
use crate::recipe::Recipe;
use crate::recipe::text::{Entry, Given};
use crate::usage;

/// An option with its value, as it is given on the command line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spelled {
    /// Long name, without dashes.
    pub name: String,
    /// Value; `None` for a flag that is set.
    pub value: Option<OsString>,
    /// True if the value is a path.
    pub is_path: bool,
}

impl Spelled {
    /// Returns the option as one argument.
    pub fn argument(&self) -> OsString {
        let mut argument = OsString::from("--");
        argument.push(&self.name);
        if let Some(value) = &self.value {
            argument.push("=");
            argument.push(value);
        }
        argument
    }

    /// Describes the option and, if its value is a file, the state of that.
    pub fn fingerprint(&self) -> String {
        let text = self.argument().to_string_lossy().into_owned();
        let file = self.value.as_ref().filter(|_| self.is_path);
        let Some(found) = file.and_then(|path| fs::metadata(path).ok()) else { return text };
        let changed = found.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        format!("{text}@{}@{}", found.len(), changed.unwrap_or_default().as_nanos())
    }
}

/// Options and positional arguments of a verb.
pub struct VerbOptions {
    pub verb: String,
    command: Command,
}

impl VerbOptions {
    /// Finds a verb by the value of the key `verb`.
    ///
    /// # Errors
    /// The verbs, if there is none of that name.
    pub fn of(verb: &Given) -> Result<Self, String> {
        let named = match verb {
            Given::Text(name) => Self::named(name),
            _ => None,
        };
        named.ok_or_else(|| {
            let all = VerbLine::command();
            let names: Vec<&str> = all.get_subcommands().map(Command::get_name).collect();
            let tip = match verb {
                Given::Text(name) => tip(&[name]),
                _ => None,
            };
            with_tip(format!("verb must be one of {}", names.join(", ")), tip)
        })
    }

    /// Finds a verb by its name.
    pub fn named(verb: &str) -> Option<Self> {
        let mut all = VerbLine::command();
        all.build();
        let command = all.find_subcommand(verb)?.clone();
        Some(Self { verb: verb.into(), command })
    }

    /// Returns the number of positional arguments.
    pub fn places(&self) -> usize {
        self.command.get_positionals().count()
    }

    /// Reports whether the verb reads one file and writes another.
    pub fn reads_and_writes(&self) -> bool {
        let names = self.command.get_positionals().map(|place| place.get_id().as_str());
        names.eq(["input", "output"])
    }

    /// Adds what a key asks for to a recipe; paths are relative to `folder`.
    ///
    /// # Errors
    /// Keys that the verb does not have, and values of the wrong kind.
    pub fn add(&self, entry: &Entry, folder: &Path, recipe: &mut Recipe) -> Result<(), String> {
        let mut places = self.command.get_positionals();
        if let Some(at) = places.position(|place| place.get_id() == entry.key.as_str()) {
            let Given::Text(text) = &entry.value else {
                return Err(format!("{} takes one value", entry.key));
            };
            let place = self.command.get_positionals().nth(at);
            recipe.places[at] = place.map(|place| value_of(place, text, folder));
            return Ok(());
        }
        let arg = self.options().find(|arg| arg.get_long() == Some(&entry.key));
        let Some(arg) = arg else {
            let reason = format!("{} has no option {:?}", self.verb, entry.key);
            return Err(with_tip(reason, tip(&[&self.verb, &format!("--{}", entry.key)])));
        };
        let values =
            values(arg, &entry.value).map_err(|reason| format!("{} {reason}", entry.key))?;
        recipe.options.extend(values.into_iter().map(|text| Spelled {
            name: entry.key.clone(),
            value: text.map(|text| value_of(arg, text, folder)),
            is_path: is_path(arg),
        }));
        Ok(())
    }

    /// Returns the options that were given on the command line, of those of this verb.
    pub fn given(&self, matches: &ArgMatches) -> Vec<Spelled> {
        let mut given = Vec::new();
        for arg in self.options().filter(|arg| !arg.is_global_set()) {
            let id = arg.get_id().as_str();
            let by_user = Some(clap::parser::ValueSource::CommandLine);
            let known = matches.try_contains_id(id).unwrap_or(false);
            let (true, Some(name)) = (known && matches.value_source(id) == by_user, arg.get_long())
            else {
                continue;
            };
            let spelled = |value: Option<&OsStr>| Spelled {
                name: name.into(),
                value: value.map(OsString::from),
                is_path: is_path(arg),
            };
            match arg.get_action() {
                ArgAction::SetTrue => given.push(spelled(None)),
                _ => given
                    .extend(matches.get_raw(id).into_iter().flatten().map(|v| spelled(Some(v)))),
            }
        }
        given
    }

    fn options(&self) -> impl Iterator<Item = &Arg> {
        let acts = |arg: &&Arg| {
            matches!(arg.get_action(), ArgAction::Set | ArgAction::Append | ArgAction::SetTrue)
        };
        self.command.get_arguments().filter(acts).filter(|arg| !arg.is_positional())
    }
}

/// Returns the tip that the command line gets for words, as recipes spell options.
fn tip(words: &[&str]) -> Option<String> {
    let words: Vec<OsString> = ["meshlod"].iter().chain(words).map(OsString::from).collect();
    let error = VerbLine::try_parse_from(&words).err()?;
    Some(usage::tip(&error, &words, VerbLine::command())?.replace("--", ""))
}

fn with_tip(reason: String, tip: Option<String>) -> String {
    tip.into_iter().fold(reason, |reason, tip| format!("{reason}; {tip}"))
}

/// Returns the values of an option in turn, `None` for a flag without one.
fn values<'g>(arg: &Arg, given: &'g Given) -> Result<Vec<Option<&'g str>>, &'static str> {
    let is_flag = matches!(arg.get_action(), ArgAction::SetTrue);
    let may_be_flag = is_flag || arg.get_num_args().is_some_and(|count| count.min_values() == 0);
    match given {
        Given::Flag(true) if may_be_flag => Ok(vec![None]),
        Given::Flag(false) if may_be_flag => Ok(Vec::new()),
        Given::Flag(_) => Err("takes a value, not true or false"),
        _ if is_flag => Err("takes true or false"),
        Given::Text(text) => Ok(vec![Some(text)]),
        Given::List(texts) if matches!(arg.get_action(), ArgAction::Append) => {
            Ok(texts.iter().map(|text| Some(text.as_str())).collect())
        }
        Given::List(_) => Err("takes one value, not a list"),
    }
}

/// Returns a value as the command line has it: paths are joined with the folder of the recipe.
fn value_of(arg: &Arg, text: &str, folder: &Path) -> OsString {
    match is_path(arg) && text != "-" {
        true => folder.join(text).into(),
        false => text.into(),
    }
}

fn is_path(arg: &Arg) -> bool {
    arg.get_value_parser().type_id() == TypeId::of::<PathBuf>()
}
