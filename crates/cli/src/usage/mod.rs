//! Wrong usage: what the parser says of it, with a tip that names what to type instead.

mod line;
mod missing;
mod options;
mod places;
mod verbs;
mod words;

use std::ffi::OsString;

use clap::Error;
use clap::error::{ContextKind, ContextValue, ErrorKind};

use self::line::Line;
pub use self::options::{tip_for_key, tip_for_verb};

/// Adds a tip to an error of the parser about `arguments`, in place of the parser's own.
pub fn explain(mut error: Error, arguments: &[OsString]) -> Error {
    let line = Line::of(arguments);
    let tip = tip(&error, &line);
    if error.kind() == ErrorKind::UnknownArgument {
        // Nobody who misspells an option wants `-- --option`.
        error.remove(ContextKind::Suggested);
    }
    if let Some(tip) = tip {
        error.remove(ContextKind::SuggestedArg);
        error.remove(ContextKind::SuggestedSubcommand);
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    error
}

fn tip(error: &Error, line: &Line) -> Option<String> {
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
