//! Comparison of what a command prints with what the book shows.
//!
//! `…` in a word of the book is a number that varies, such as seconds; a line of nothing else is
//! any number of lines.

use std::ops::Range;

const ANY: char = '…';
const ANY_LINES: &str = "…";

/// Reports whether the book shows what was printed.
pub fn matches(shown: &[&str], printed: &[&str]) -> bool {
    matches_from(shown, 0..shown.len(), printed, |rest| rest.is_empty())
}

/// Compares a range of the shown lines with what was printed, of which `rest_matches` judges what is
/// behind them.
fn matches_from(
    shown: &[&str],
    Range { start, end }: Range<usize>,
    printed: &[&str],
    rest_matches: fn(&[&str]) -> bool,
) -> bool {
    let below = |printed| matches_from(shown, start + 1..end, printed, rest_matches);
    if start == end {
        return rest_matches(printed);
    }
    match (shown[start], printed.split_first()) {
        (ANY_LINES, _) => (0..=printed.len()).any(|skipped| below(&printed[skipped..])),
        (_, Some((line, rest))) => same_line(shown, start, line) && below(rest),
        (_, None) => false,
    }
}

/// Compares a line. Columns move with the width of a number, so spaces do not count in a line with
/// one that varies, nor in a heading above it.
fn same_line(shown: &[&str], at: usize, printed: &str) -> bool {
    let varies = |line: &&str| *line != ANY_LINES && line.contains(ANY);
    match shown[at..].iter().take(2).any(varies) {
        true => line_matches(shown[at], printed),
        false => shown[at] == printed,
    }
}

/// Returns the printed lines as the book is to show them: with `…` where it is now.
pub fn rewritten(shown: &[&str], printed: &[&str]) -> Vec<String> {
    if matches(shown, printed) {
        return shown.iter().map(ToString::to_string).collect();
    }
    let is_any = |line: &&str| *line == ANY_LINES;
    let (Some(first), Some(last)) = (shown.iter().position(is_any), shown.iter().rposition(is_any))
    else {
        return kept(shown, printed);
    };
    let tail = shown.len() - last - 1;
    if printed.len() < first + tail {
        return kept(&[], printed);
    }
    let mut lines = kept(&shown[..first], &printed[..first]);
    lines.push(ANY_LINES.into());
    lines.extend(kept(&shown[last + 1..], &printed[printed.len() - tail..]));
    lines
}

/// Returns the first line that differs, as shown and as printed.
pub fn first_difference<'t>(shown: &[&'t str], printed: &[&'t str]) -> [&'t str; 2] {
    let same = (0..=shown.len()).rev().find(|&n| matches_from(shown, 0..n, printed, |_| true));
    let at = same.unwrap_or_default();
    // Lines that are skipped may end anywhere, so what was printed is only known before them.
    let skips = shown[..at.min(shown.len())].contains(&ANY_LINES);
    let printed = if skips { None } else { printed.get(at).copied() };
    [shown.get(at).copied().unwrap_or_default(), printed.unwrap_or_default()]
}

fn line_matches(shown: &str, printed: &str) -> bool {
    let [shown, printed] = [shown, printed].map(str::split_whitespace);
    shown.clone().count() == printed.clone().count()
        && shown.zip(printed).all(|(shown, printed)| word_matches(shown, printed))
}

fn word_matches(shown: &str, printed: &str) -> bool {
    let Some((before, after)) = shown.split_once(ANY) else { return shown == printed };
    let number = printed.strip_prefix(before).and_then(|rest| rest.strip_suffix(after));
    let is_of_number = |c: char| c.is_ascii_digit() || ".,-+e".contains(c);
    number.is_some_and(|number| !number.is_empty() && number.chars().all(is_of_number))
}

/// Puts `…` into the printed lines in place of words where the shown lines have it.
fn kept(shown: &[&str], printed: &[&str]) -> Vec<String> {
    let shown = shown.iter().copied().chain(std::iter::repeat(""));
    printed.iter().zip(shown).map(|(printed, shown)| kept_line(shown, printed)).collect()
}

fn kept_line(shown: &str, printed: &str) -> String {
    let [old, new] = [shown, printed].map(|line| line.split_whitespace().count());
    if old != new {
        return printed.to_owned();
    }
    let mut words = shown.split_whitespace();
    let pieces = printed.split(' ').map(|piece| {
        let varies = |word: &&str| word.contains(ANY) && word_matches(word, piece);
        if piece.is_empty() { piece } else { words.next().filter(varies).unwrap_or(piece) }
    });
    pieces.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_without_a_mark_are_compared_exactly() {
        assert!(matches(&["a  b"], &["a  b"]));
        assert!(!matches(&["a b"], &["a  b"]));
        assert!(!matches(&["a"], &["a", "b"]) && !matches(&["a", "b"], &["a"]));
    }

    #[test]
    fn a_mark_is_one_number_of_any_width() {
        assert!(matches(&["in … s, 3 faces"], &["in   10.25 s, 3 faces"]));
        assert!(matches(&["(…%)"], &["(1.5e-3%)"]));
        assert!(matches(&["faces   s", "3   …"], &["faces  s", "3  1"]), "of a narrower column");
        assert!(!matches(&["3 …", "a  b"], &["3 1", "a b"]), "other lines are compared exactly");
        for other in ["in s, 3 faces", "in some s, 3 faces", "in 1 s, 4 faces", "in 1 2 s, 3 faces"]
        {
            assert!(!matches(&["in … s, 3 faces"], &[other]), "{other}");
        }
    }

    #[test]
    fn a_line_of_a_mark_is_any_number_of_lines() {
        for printed in [&["a", "b"][..], &["a", "x", "b"], &["a", "b", "y", "b"]] {
            assert!(matches(&["a", "…", "b"], printed), "{printed:?}");
        }
        assert!(!matches(&["a", "…", "b"], &["a", "x"]));
    }

    #[test]
    fn what_still_holds_is_not_rewritten() {
        assert_eq!(rewritten(&["a", "…"], &["a", "b"]), ["a", "…"]);
    }

    #[test]
    fn marks_stay_where_they_were() {
        assert_eq!(rewritten(&["3 faces in …"], &["4 faces in  2.5"]), ["4 faces in  …"]);
        let shown = ["1 face", "…", "in … s"];
        let printed = ["2 faces", "x", "y", "in 3 s"];
        assert_eq!(rewritten(&shown, &printed), ["2 faces", "…", "in … s"]);
        assert_eq!(rewritten(&["a", "…", "b"], &["c"]), ["c"]);
        assert_eq!(rewritten(&[], &["new"]), ["new"]);
    }

    #[test]
    fn the_first_difference_is_named() {
        assert_eq!(first_difference(&["a", "b"], &["a", "c"]), ["b", "c"]);
        assert_eq!(first_difference(&["a"], &["a", "c"]), ["", "c"]);
        assert_eq!(first_difference(&["a", "b"], &["a"]), ["b", ""]);
        assert_eq!(first_difference(&["…", "b"], &["a"]), ["b", ""]);
        assert_eq!(first_difference(&["a s", "b …"], &["a s", "c 1"]), ["b …", "c 1"]);
    }
}
