//! Tips for options that a verb does not have.

use clap::error::ContextKind;
use clap::{Command, Error};

use crate::usage::line::{TypedLine, long_option};
use crate::usage::words::{Meant, OPTIONS, has};
use crate::usage::{invalid, verbs};

/// Dashes that text programs put in place of a hyphen.
const LONG_DASHES: [char; 3] = ['–', '—', '−'];

/// Says which option or place was meant by a word that begins with a hyphen.
pub fn tip(word: &str, error: &Error, line: &TypedLine) -> Option<String> {
    let name = name_of(word);
    by_table(name_of(whole(word, line)), line)
        .or_else(|| by_table(name, line))
        .or_else(|| verbs::of_option(name, line))
        .or_else(|| elsewhere(name, line))
        .or_else(|| Some(format!("did you mean {}?", invalid(error, ContextKind::SuggestedArg)?)))
}

/// Says that an option begins with two hyphens, if it was typed with one, or with dashes.
pub fn dashes(line: &TypedLine) -> Option<String> {
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

/// Returns the word of the line of which the parser has taken the first letter: `-si` for `-s`.
fn whole<'l>(word: &'l str, line: &'l TypedLine) -> &'l str {
    let whole = line.words.iter().find(|other| !word.starts_with("--") && other.starts_with(word));
    whole.map_or(word, String::as_str)
}

fn name_of(word: &str) -> &str {
    let name = word.trim_start_matches('-').trim_start_matches(LONG_DASHES);
    name.split(['=', ' ']).next().unwrap_or_default()
}

/// Looks a name up among those that other programs have for our options.
fn by_table(name: &str, line: &TypedLine) -> Option<String> {
    let (_, meant) = OPTIONS.iter().find(|(names, _)| has(names, name))?;
    match meant {
        Meant::Option(options) => {
            match options.iter().find(|option| line.option(option).is_some()) {
                Some(option) => Some(format!("did you mean --{option}?")),
                None => elsewhere(options[0], line),
            }
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
fn elsewhere(name: &str, line: &TypedLine) -> Option<String> {
    let has = |verb: &&Command| long_option(verb, name).is_some();
    let verbs: Vec<&str> =
        line.program.get_subcommands().filter(has).map(Command::get_name).collect();
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
