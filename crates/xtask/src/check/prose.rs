//! Checks comments and strings for refused phrases.

use crate::check::source::{Piece, Source};

/// Openings that leave a summary line without a subject, or make a clause its subject.
const OPENINGS: [&str; 9] =
    ["The same", "That of", "Those of", "Of", "Who", "What", "How many", "How much", "How far"];
/// Germanisms for "is invalid" and "there is no". Kept as two words so that this file passes.
const NEGATIONS: [[&str; 2]; 2] = [["is", "none"], ["are", "none"]];

/// Lists doc comments with a refused opening, and comments and strings with a refused phrase.
///
/// The summary line is the start of a `///` or `//!` block.
pub fn check(sources: &[Source]) -> Vec<String> {
    let mut errors = Vec::new();
    for Source { path, comments, strings, .. } in sources {
        for block in blocks(comments) {
            if let Some((line, opening)) = block.refused_opening() {
                errors.push(format!("{path}:{line}: a summary line opens with `{opening}`"));
            }
            errors.extend(negations(path, &block.words));
        }
        for string in strings {
            errors.extend(negations(path, &words(string).collect::<Vec<_>>()));
        }
    }
    errors
}

/// A run of comments on consecutive lines with one marker.
struct Block<'s> {
    last_line: usize,
    marker: &'s str,
    words: Vec<Word<'s>>,
}

/// A word without punctuation, and its line.
type Word<'s> = (usize, &'s str);

impl Block<'_> {
    /// Returns the line and the refused opening of a doc comment, if it has one.
    fn refused_opening(&self) -> Option<(usize, &'static str)> {
        let (line, _) = *self.words.first()?;
        let opens_with = |opening: &&str| {
            let mut words = self.words.iter().map(|(_, word)| word);
            opening.split(' ').all(|expected| words.next() == Some(&expected))
        };
        let is_documenting = ["///", "//!"].contains(&self.marker);
        let opening = OPENINGS.into_iter().filter(|_| is_documenting).find(opens_with)?;
        Some((line, opening))
    }
}

fn blocks(comments: &[Piece]) -> Vec<Block<'_>> {
    let mut blocks: Vec<Block<'_>> = Vec::new();
    for comment in comments {
        let marker = ["////", "///", "//!", "//", "/*"];
        let marker = marker.into_iter().find(|marker| comment.text.starts_with(marker));
        let marker = marker.unwrap_or_default();
        match blocks.last_mut() {
            Some(block) if block.last_line + 1 == comment.line && block.marker == marker => {
                block.last_line = comment.line;
                block.words.extend(words(comment));
            }
            _ => {
                let words = words(comment).collect();
                blocks.push(Block { last_line: comment.line, marker, words });
            }
        }
    }
    blocks
}

/// Splits a comment or string into words.
fn words(piece: &Piece) -> impl Iterator<Item = Word<'_>> {
    let is_around = |c: char| !c.is_alphanumeric() && c != '_';
    piece.text.lines().enumerate().flat_map(move |(i, line)| {
        let words = line.split_whitespace().map(move |word| word.trim_matches(is_around));
        words.filter(|word| !word.is_empty()).map(move |word| (piece.line + i, word))
    })
}

fn negations(path: &str, words: &[Word<'_>]) -> Vec<String> {
    let before = std::iter::once("").chain(words.iter().map(|word| word.1));
    let pairs = words.windows(2).map(|pair| (pair[0].0, [pair[0].1, pair[1].1]));
    // "If there is ..." is plain English.
    let pairs = before.zip(pairs).filter(|(before, _)| *before != "there").map(|(_, pair)| pair);
    let found = pairs.filter(|(_, pair)| NEGATIONS.contains(pair));
    found
        .map(|(line, pair)| {
            format!("{path}:{line}: `{}`: say what is invalid or missing", pair.join(" "))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::project::Text;

    fn errors(text: &str) -> Vec<String> {
        check(&[Source::new(&Text { path: "a.rs".into(), text: text.into() })])
    }

    #[test]
    fn every_refused_opening_is_named_with_its_place() {
        for opening in OPENINGS {
            let expected = format!("a.rs:2: a summary line opens with `{opening}`");
            for marker in ["///", "//!"] {
                let text = format!("fn f() {{}}\n{marker} {opening} it.\n{marker} More.");
                assert_eq!(errors(&text), [&*expected]);
            }
        }
    }

    #[test]
    fn an_opening_may_be_wrapped_or_followed_by_punctuation() {
        assert_eq!(errors("/// The\n/// same twice.").len(), 1);
        assert_eq!(errors("/// Who, then?").len(), 1);
    }

    #[test]
    fn only_whole_words_at_the_beginning_of_a_summary_count() {
        for fine in [
            "/// Whole faces.",
            "/// Offset.",
            "/// Computes.\n///\n/// What it is.",
            "// What is.",
        ] {
            assert_eq!(errors(fine), [""; 0], "{fine}");
        }
    }

    #[test]
    fn negations_are_found_in_comments_and_strings_across_lines() {
        for verb in ["is", "are"] {
            for text in [
                format!("// It {verb}\n// none."),
                format!("f(\"it {verb} \\\n  none: take two\")"),
            ] {
                let expected =
                    format!("a.rs:1: `{verb} {}`: say what is invalid or missing", "none");
                assert_eq!(errors(&text), [&*expected], "{text}");
            }
        }
        assert_eq!(errors("if x.is_none() {} // it is nonempty"), [""; 0]);
        let plain = format!("/// `None` if there is {}.", "none");
        assert_eq!(errors(&plain), [""; 0]);
    }
}
