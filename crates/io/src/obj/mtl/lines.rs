//! Lines of an MTL library.

use crate::error::ParseError;
use crate::text::cursor::{TextCursor, text_of};

/// Line of a library, joined with the lines that continue it after a backslash.
#[derive(Debug, PartialEq)]
pub(super) struct Line {
    /// Number of its first line, counted from 1.
    pub number: usize,
    /// Text without line ends; continuations follow a space.
    pub text: String,
}

/// Splits a library into lines. Bytes that are not UTF-8 are read as Latin-1.
///
/// # Errors
/// Bytes that are not text.
pub(super) fn lines(bytes: &[u8]) -> Result<Vec<Line>, ParseError> {
    if bytes.is_empty() {
        return Ok(Vec::new());
    }
    let mut text = TextCursor::new(bytes)?;
    let mut lines: Vec<Line> = Vec::new();
    let mut continues = false;
    loop {
        let number = text.line();
        let raw = text.raw_line();
        let own = raw.strip_suffix(b"\\").unwrap_or(raw);
        let is_comment = raw.trim_ascii_start().starts_with(b"#");
        match lines.last_mut().filter(|_| continues) {
            Some(line) => line.text = format!("{} {}", line.text, text_of(own)),
            None => lines.push(Line { number, text: text_of(if is_comment { raw } else { own }) }),
        }
        continues = own.len() < raw.len() && (continues || !is_comment);
        if !text.after_raw_line() {
            return Ok(lines);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_end_in_three_ways_and_may_go_on() {
        let line = |number, text: &str| Line { number, text: text.to_owned() };
        assert_eq!(
            lines(b"\xef\xbb\xbfa b\r\n\tKd 1 \\\n 0 0\r# c \\\n\nd \xe4\n").unwrap(),
            [
                line(1, "a b"),
                line(2, "\tKd 1   0 0"),
                line(4, "# c \\"),
                line(5, ""),
                line(6, "d ä")
            ]
        );
        assert_eq!(lines(b"").unwrap(), []);
        lines(b"a\0b").unwrap_err();
    }
}
