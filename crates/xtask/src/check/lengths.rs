//! Checks that long source files give a reason for their length.

use crate::project::Text;

/// Number of lines above which a file is listed, and above which it must give a reason.
const LONG: usize = 300;
const TOO_LONG: usize = 600;
/// Start of the line that gives the reason, and the number of leading lines searched for it.
const REASON: &str = "//! Long because ";
const REASON_WITHIN: usize = 10;

/// Long source files that were found: some are only reported, others are errors.
#[derive(Debug, Default, PartialEq)]
pub struct Lengths {
    /// Source files that are long, but still allowed.
    pub notes: Vec<String>,
    /// Source files that are too long and give no reason.
    pub errors: Vec<String>,
}

/// Lists source files of more than 300 lines, and as errors those of more than 600 that do not say
/// `//! Long because …` in their first ten lines.
pub fn check(sources: &[Text]) -> Lengths {
    let mut found = Lengths::default();
    for source in sources {
        let lines = source.text.lines().count();
        let reason = source.text.lines().take(REASON_WITHIN).any(|line| line.starts_with(REASON));
        if lines > TOO_LONG && !reason {
            let path = &source.path;
            found.errors.push(format!(
                "{path}: {lines} lines: split the file, or begin it with `{REASON}…`"
            ));
        } else if lines > LONG {
            found.notes.push(format!("{}: {lines} lines", source.path));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(first: &str, lines: usize) -> Text {
        Text { path: "a.rs".into(), text: format!("{first}\n{}", "x\n".repeat(lines - 1)) }
    }

    #[test]
    fn short_is_silent_long_is_noted_too_long_is_refused() {
        assert_eq!(check(&[source("", 300)]), Lengths::default());
        assert_eq!(check(&[source("", 600)]).notes, ["a.rs: 600 lines"]);
        assert_eq!(check(&[source("", 601)]).errors.len(), 1);
    }

    #[test]
    fn a_reason_excuses_length() {
        let found = check(&[source("//! Long because it is a table.", 700)]);
        assert_eq!((found.notes.len(), found.errors.len()), (1, 0));
    }
}
