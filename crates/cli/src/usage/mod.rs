//! Wrong usage: what the parser says of it, with a tip that names what to type instead.

mod line;
mod missing;
mod options;
mod places;
mod values;
mod verbs;
mod words;

use std::ffi::OsString;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, Error};

use self::line::TypedLine;

/// Adds a tip to an error of the parser of `program`, in place of the parser's own.
pub fn explain(mut error: Error, arguments: &[OsString], program: Command) -> Error {
    let tip = tip(&error, arguments, program);
    if error.kind() == ErrorKind::UnknownArgument {
        // Nobody who misspells an option wants `-- --option`.
        error.remove(ContextKind::Suggested);
    }
    if let Some(tip) = tip {
        error.remove(ContextKind::SuggestedArg);
        error.remove(ContextKind::SuggestedSubcommand);
        error.remove(ContextKind::SuggestedValue);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

/// Names what to type in place of what an error of the parser of `program` is about.
pub fn tip(error: &Error, arguments: &[OsString], program: Command) -> Option<String> {
    let line = &TypedLine::of(arguments, program);
    let of_kind = || match error.kind() {
        ErrorKind::UnknownArgument => {
            let word = invalid(error, ContextKind::InvalidArg)?;
            match word.starts_with('-') {
                true => options::tip(word, error, line),
                false => places::tip(word, line),
            }
        }
        ErrorKind::InvalidSubcommand => {
            verbs::tip(invalid(error, ContextKind::InvalidSubcommand)?, error, line)
        }
        ErrorKind::InvalidValue | ErrorKind::ValueValidation => values::tip(error),
        ErrorKind::MissingRequiredArgument => missing::tip(error, line),
        _ => None,
    };
    match error.use_stderr() {
        true => options::dashes(line).or_else(of_kind),
        false => None,
    }
}

/// Returns the word that the parser does not know.
fn invalid(error: &Error, kind: ContextKind) -> Option<&str> {
    match error.get(kind)? {
        ContextValue::String(word) => Some(word),
        _ => None,
    }
}

/// Returns the reason of an error and its tip in one line.
pub fn one_line(error: &Error) -> String {
    let text = error.render().to_string();
    let mut paragraphs = text.split("\n\n").map(one_space);
    let reason = paragraphs.next().unwrap_or_default().replacen("error: ", "", 1);
    let tip = paragraphs.find_map(|text| text.strip_prefix("tip: ").map(str::to_owned));
    tip.into_iter().fold(reason, |reason, tip| format!("{reason}; {tip}"))
}

fn one_space(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
