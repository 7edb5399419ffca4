//! Tips for words that have no place on the command line: too many files, values without an option.

use std::path::Path;

use clap::Arg;

use crate::options::{number, parse};
use crate::usage::line::TypedLine;

/// Says what to do with a word that has no place.
pub fn tip(word: &str, line: &TypedLine) -> Option<String> {
    split_path(line)
        .or_else(|| split_value(word, line))
        .or_else(|| report(word, line))
        .or_else(|| value(word, line))
        .or_else(|| out(word, line))
        .or_else(|| several(word, line))
}

/// A path with spaces that the shell has split.
fn split_path(line: &TypedLine) -> Option<String> {
    let mut joined = line.words.windows(2).map(|pair| pair.join(" "));
    let path = joined.find(|path| Path::new(path).exists())?;
    Some(format!("a path with spaces needs quotes: \"{path}\""))
}

/// A number that is apart from its unit: `10 %`.
fn split_value(word: &str, line: &TypedLine) -> Option<String> {
    let before = line.before(word).filter(|before| number::number(before).is_ok())?;
    let joined = format!("{before}{}", word.replace("percent", "%"));
    let is_unit = word == "%" || word == "percent" || number::metres(&format!("1{word}")).is_some();
    (is_unit && number::number(word).is_err())
        .then(|| format!("write it without a space: {joined}"))
}

/// A file for the JSON.
fn report(word: &str, line: &TypedLine) -> Option<String> {
    let is_report = line.before(word)? == "--json";
    is_report.then(|| format!("--json prints to standard output: write --json > {word}"))
}

/// A number without its option, or one of a list with spaces.
fn value(word: &str, line: &TypedLine) -> Option<String> {
    let size = parse::size(word.trim_end_matches(',')).ok()?;
    let of_list = |arg: &Arg| matches!(arg.get_value_delimiter(), Some(','));
    let list = line.words.iter().rposition(|other| {
        other.strip_prefix("--").and_then(|name| line.option(name)).is_some_and(of_list)
    });
    if let Some(at) = list {
        let values = line.words[at + 1..].iter().map(|value| value.trim_end_matches(','));
        let values: Vec<&str> = values.take_while(|value| parse::size(value).is_ok()).collect();
        return Some(format!(
            "write a list without spaces: {} {}",
            line.words[at],
            values.join(",")
        ));
    }
    let option = match size.faces() {
        Some(_) => ["faces", "levels"],
        None => ["ratio", "levels"],
    };
    let option = option.iter().find(|name| line.option(name).is_some())?;
    Some(format!("did you mean --{option} {word}?"))
}

/// A file to write, of a verb that has an option for it.
fn out(word: &str, line: &TypedLine) -> Option<String> {
    line.option("out")
        .filter(|_| Path::new(word).extension().is_some() && !Path::new(word).exists())?;
    Some(format!("did you mean --out {word}?"))
}

/// More files than the verb takes.
fn several(word: &str, line: &TypedLine) -> Option<String> {
    let verb = line.verb_name()?;
    if verb == "compare" {
        return Some(format!(
            "compare takes one mesh; measure compares two: meshlod measure {} {word}",
            line.before(word)?
        ));
    }
    if !line.reads_and_writes() {
        return None;
    }
    let recipe = match verb {
        "simplify" => String::new(),
        verb => format!(" --recipe '{{\"verb\": \"{verb}\"}}'"),
    };
    Some(format!("{verb} takes one file; for several: meshlod batch <IN>... <OUT FOLDER>{recipe}"))
}
