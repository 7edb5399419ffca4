//! Tips for command lines without a verb that we have.

use std::path::Path;

use clap::Error;
use clap::error::{ContextKind, ContextValue};
use meshlod::FileKind;

use crate::usage::line::TypedLine;
use crate::usage::words::{VERBS, VERBS_OF_OPTIONS, has};

/// Says which verb was meant by a word in its place, which may be a file.
pub fn tip(word: &str, error: &Error, line: &TypedLine) -> Option<String> {
    if is_file(word) {
        return Some(format!("name a verb first: {}", with_verb(&line.paths())));
    }
    let known = VERBS.iter().find(|(_, words)| has(words, &word.to_lowercase()));
    let verb = known.map(|(verb, _)| *verb).or_else(|| similar(error))?;
    Some(format!("did you mean {verb}?"))
}

/// Says which verb does what an option was to do.
pub fn of_option(name: &str, line: &TypedLine) -> Option<String> {
    if line.verb.is_none() && line.program.find_subcommand(name).is_some() {
        return Some(format!("a verb has no hyphens: meshlod {name}"));
    }
    let (verb, _) = VERBS_OF_OPTIONS.iter().find(|(_, options)| has(options, name))?;
    Some(format!("meshlod {verb} does that"))
}

fn is_file(word: &str) -> bool {
    let path = Path::new(word);
    FileKind::of_path(path).is_ok() || path.exists() || word.contains('*')
}

/// Returns the command that is probably meant by files alone.
fn with_verb(paths: &[&str]) -> String {
    let &[input, output] = paths else { return format!("meshlod info {}", paths.join(" ")) };
    let suffix = |path| Path::new(path).extension().unwrap_or_default().to_ascii_lowercase();
    match suffix(output).to_str().unwrap_or_default() {
        "mlod" => format!("meshlod build {input} {output}"),
        "mlq" | "mlz" => format!("meshlod compress {input} {output}"),
        "png" => format!("meshlod render {input} {output}"),
        _ if suffix(input) == suffix(output) => {
            format!("meshlod simplify {input} {output} --ratio 10%")
        }
        _ => format!(
            "meshlod convert {input} {output}, or meshlod simplify {input} {output} --ratio 10%"
        ),
    }
}

/// Returns the verb that the parser finds similar.
fn similar(error: &Error) -> Option<&str> {
    match error.get(ContextKind::SuggestedSubcommand)? {
        ContextValue::Strings(verbs) => verbs.last().map(String::as_str),
        ContextValue::String(verb) => Some(verb),
        _ => None,
    }
}
