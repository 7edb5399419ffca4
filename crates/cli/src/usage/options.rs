//! Tips for options that a verb does not have.

use std::ffi::OsString;

use clap::error::ContextKind;
use clap::{Command, CommandFactory, Error, Parser};

use crate::command::VerbLine;
use crate::usage::line::{Line, long_option};
use crate::usage::words::{Meant, OPTIONS};
use crate::usage::{invalid, verbs};

/// Dashes that text programs put in place of a hyphen.
const LONG_DASHES: [char; 3] = ['–', '—', '−'];

/// Says which option or place was meant by a word that begins with a hyphen.
pub fn tip(word: &str, error: &Error, line: &Line) -> Option<String> {
    let name = name_of(word);
    by_table(name, line)
        .or_else(|| verbs::of_option(name, line))
        .or_else(|| elsewhere(name, line))
        .or_else(|| Some(format!("did you mean {}?", invalid(error, ContextKind::SuggestedArg)?)))
}

/// Says that an option begins with two hyphens, if it was typed with one, or with dashes.
pub fn dashes(line: &Line) -> Option<String> {
    line.words.iter().find_map(|word| {
        let name = name_of(word);
        line.option(name).filter(|_| name.len() > 1)?;
        let is_single = word.starts_with('-') && !word.starts_with("--");
        match word.starts_with(LONG_DASHES) || word[1..].starts_with(LONG_DASHES) {
            true => Some(format!("type two hyphens, not a dash: --{name}")),
            false => is_single.then(|| format!("long options have two hyphens: --{name}")),
        }
    })
}

/// Returns the tip for a key of a recipe that its verb does not have.
pub fn tip_for_key(verb: &str, key: &str) -> Option<String> {
    let tip = tip_of(&["meshlod", verb, &format!("--{key}")])?;
    Some(tip.replace("--", ""))
}

/// Returns the tip for a verb that is none.
pub fn tip_for_verb(verb: &str) -> Option<String> {
    tip_of(&["meshlod", verb])
}

fn tip_of(words: &[&str]) -> Option<String> {
    let words: Vec<OsString> = words.iter().map(OsString::from).collect();
    super::tip(&VerbLine::try_parse_from(&words).err()?, &Line::of(&words))
}

fn name_of(word: &str) -> &str {
    let name = word.trim_start_matches('-').trim_start_matches(LONG_DASHES);
    name.split(['=', ' ']).next().unwrap_or_default()
}

/// Looks a name up among those that other programs have for our options.
fn by_table(name: &str, line: &Line) -> Option<String> {
    let (_, meant) = OPTIONS.iter().find(|(names, _)| names.contains(&name))?;
    match meant {
        Meant::Option(options) => {
            let option = options.iter().find(|option| line.option(option).is_some())?;
            Some(format!("did you mean --{option}?"))
        }
        Meant::Out if line.option("out").is_some() => {
            Some(format!("did you mean {}?", line.option("out")?))
        }
        Meant::Place | Meant::Out => {
            let form = line.form().unwrap_or_else(|| "meshlod simplify <IN> <OUT>".into());
            Some(format!("files have no option, only a place: {form}"))
        }
        Meant::Text(text) => Some((*text).to_owned()),
    }
}

/// Names the verbs that have the option.
fn elsewhere(name: &str, line: &Line) -> Option<String> {
    let all = VerbLine::command();
    let has = |verb: &&Command| long_option(verb, name).is_some();
    let verbs: Vec<&str> = all.get_subcommands().filter(has).map(Command::get_name).collect();
    let (last, others) = verbs.split_last()?;
    let verbs = match others {
        [] => (*last).to_owned(),
        others => format!("{} and {last}", others.join(", ")),
    };
    Some(match line.verb {
        Some(_) => format!("--{name} is an option of {verbs}"),
        None => format!("--{name} is an option of {verbs}: name the verb first"),
    })
}
