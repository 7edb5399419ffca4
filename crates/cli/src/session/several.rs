//! Verbs that take several files: an answer for each, in one.

use std::path::{Path, PathBuf};

use serde_json::json;

use crate::session::answer::{Answer, Outcome};
use crate::session::failure::Failure;
use crate::session::{Session, files, patterns};

/// Answers for each file in turn; a failure of one does not stop the others. Of one file that is
/// named, the answer is its own.
pub fn answer(
    inputs: &[PathBuf],
    session: &Session,
    each: impl Fn(&Path) -> Result<Answer, Failure>,
) -> Result<Answer, Failure> {
    let paths = paths(inputs)?;
    if let ([input], [path]) = (inputs, &paths[..])
        && input == path
    {
        return each(path);
    }
    let (mut answers, mut texts, mut outcomes) = (Vec::new(), Vec::new(), Vec::new());
    for path in &paths {
        let mut answer = each(path).unwrap_or_else(|failure| failed(path, &failure, session));
        session.complete(&mut answer);
        answers.push(answer.json);
        texts.push(answer.text);
        outcomes.push(answer.outcome);
    }
    texts.retain(|text| !text.is_empty());
    let gap = if texts.iter().any(|text| text.lines().count() > 1) { "\n" } else { "" };
    let answer = Answer::new(json!({ "files": answers }), texts.join(gap));
    Ok(Answer { outcome: worst(&outcomes), ..answer })
}

/// Replaces patterns by what they match, where no shell has done so.
fn paths(inputs: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let of_input = |input: &PathBuf| match patterns::is_pattern(input) {
        true => patterns::files_of(input),
        false => Ok(vec![input.clone()]),
    };
    let found: Result<Vec<_>, _> = inputs.iter().map(of_input).collect();
    found.map(|found| found.concat())
}

/// Prints why there is no answer for a file, and makes one that says so.
fn failed(path: &Path, failure: &Failure, session: &Session) -> Answer {
    session.complain(failure);
    let json = json!({
        "file": files::name(path),
        "failure": failure.to_json(),
        "exit": failure.exit_code(),
    });
    let outcome = if failure.exit_code() == 3 { Outcome::Found } else { Outcome::Missed };
    Answer { outcome, ..Answer::new(json, String::new()) }
}

fn worst(outcomes: &[Outcome]) -> Outcome {
    let all = [Outcome::Missed, Outcome::Found];
    all.into_iter().find(|outcome| outcomes.contains(outcome)).unwrap_or_default()
}
