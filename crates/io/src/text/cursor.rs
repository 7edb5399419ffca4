//! Cursor for parsing text formats line by line in one pass over the bytes, with numbers parsed in
//! place.

use crate::error::ParseError;

/// Cursor over the lines of a text.
///
/// Lines end with LF, CR LF or CR; the end of the text ends the last one. Every byte up to and
/// including the space counts as blank. A backslash at the end of a line continues the statement on
/// the next one.
#[derive(Clone)]
pub(crate) struct TextCursor<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    /// Number of attribute values read that are not finite.
    not_finite: usize,
}

/// Reason why a file with a zero byte is refused.
const NOT_TEXT: &str = "a zero byte: this is not a text file";

impl<'a> TextCursor<'a> {
    /// Creates a cursor at the first line, after a byte order mark if there is one.
    ///
    /// # Errors
    /// If the text is empty, is UTF-16 or contains a NUL byte.
    pub(crate) fn new(bytes: &'a [u8]) -> Result<Self, ParseError> {
        if bytes.is_empty() {
            return Err(ParseError::byte(0, "the file is empty"));
        }
        if bytes.starts_with(b"\xfe\xff") || bytes.starts_with(b"\xff\xfe") {
            return Err(ParseError::byte(0, "this is UTF-16 text; save it as UTF-8"));
        }
        if let Some(at) = bytes.iter().position(|&b| b == 0) {
            return Err(ParseError::byte(at, NOT_TEXT));
        }
        let at = if bytes.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Ok(Self { bytes, at, line: 1, not_finite: 0 })
    }

    /// Creates a cursor at the first line of a later part of a text, by the number of that line and
    /// of the first byte.
    ///
    /// # Errors
    /// If the part contains a NUL byte.
    pub(crate) fn of_part(bytes: &'a [u8], line: usize, first: usize) -> Result<Self, ParseError> {
        match bytes.iter().position(|&b| b == 0) {
            Some(at) => Err(ParseError::byte(first + at, NOT_TEXT)),
            None => Ok(Self { bytes, at: 0, line, not_finite: 0 }),
        }
    }

    /// Returns the number of bytes at the beginning of a part of a text that end with a statement;
    /// 0 if none ends in it for certain.
    pub(crate) fn whole_statements(bytes: &[u8]) -> usize {
        let ends = |at: usize| {
            // The other half of a line end may follow.
            let is_half = bytes[at] == b'\r' && at + 1 == bytes.len();
            let pair = bytes[at] == b'\n' && at > 0 && bytes[at - 1] == b'\r';
            let before = at - usize::from(pair);
            let continues = before > 0 && bytes[before - 1] == b'\\';
            is_line_end(bytes[at]) && !is_half && !continues
        };
        (0..bytes.len()).rev().find(|&at| ends(at)).map_or(0, |at| at + 1)
    }

    /// Returns the current line, counted from 1.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    /// Returns the number of bytes left, an upper bound for every count in a header.
    pub(crate) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Creates an error at the current line.
    #[cold]
    pub(crate) fn error(&self, reason: impl Into<String>) -> ParseError {
        ParseError::line(self.line, reason)
    }

    /// Creates an error at the current line: expected `what` at the cursor.
    #[cold]
    pub(crate) fn refuse(&self, what: &str) -> ParseError {
        self.error(format!("{} is not {what}", quoted(self.here())))
    }

    /// Moves to the next byte that is not blank; returns false if the statement ends before one.
    /// A statement ends with its line, with the text or at a `#`.
    #[inline]
    pub(crate) fn more(&mut self) -> bool {
        loop {
            match self.byte() {
                b'\n' | b'\r' | b'#' => return false,
                0..=b' ' => self.at += 1,
                b'\\' if self.continues() => self.end_line(),
                _ => return true,
            }
        }
    }

    /// Reads the bytes up to the next blank; empty if the statement has ended.
    pub(crate) fn word(&mut self) -> &'a [u8] {
        if !self.more() {
            return &[];
        }
        let word = self.here();
        self.at += word.len();
        word
    }

    /// Skips the remaining words of the statement and returns their number.
    pub(crate) fn words_left(&mut self) -> usize {
        let mut count = 0;
        while !self.word().is_empty() {
            count += 1;
        }
        count
    }

    /// Reads the rest of the line as a name, trimmed, with any `#` in it.
    pub(crate) fn name(&mut self) -> String {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|&b| is_line_end(b)).unwrap_or(rest.len());
        self.at += end;
        text_of(rest[..end].trim_ascii())
    }

    /// Returns the rest of the line without its end; backslashes have no special meaning.
    pub(crate) fn raw_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|&b| is_line_end(b)).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    /// Moves to the next line after [`TextCursor::raw_line`]; returns false at the end of the text.
    pub(crate) fn after_raw_line(&mut self) -> bool {
        if self.at == self.bytes.len() {
            return false;
        }
        self.end_line();
        self.at < self.bytes.len()
    }

    /// Moves to the start of the next line, skipping the rest of the statement; returns false at
    /// the end of the text.
    #[inline]
    pub(crate) fn next_line(&mut self) -> bool {
        while self.more() {
            self.at += self.here().len();
        }
        // In a comment, a backslash at the end of the line does not continue it.
        while !is_line_end(self.byte()) {
            self.at += 1;
        }
        if self.at == self.bytes.len() {
            return false;
        }
        self.end_line();
        self.at < self.bytes.len()
    }

    /// Skips blanks, line ends and comments; returns false at the end of the text.
    pub(crate) fn more_anywhere(&mut self) -> bool {
        loop {
            if self.more() {
                return true;
            }
            if !self.next_line() {
                return false;
            }
        }
    }

    /// Reads a finite number.
    ///
    /// # Errors
    /// `need` if the statement ends first; otherwise the word that is not a finite number.
    #[inline]
    pub(crate) fn number(&mut self, need: &str) -> Result<f64, ParseError> {
        match self.any_number(need)? {
            Some(x) => Ok(x),
            None => Err(self.refuse("a finite number")),
        }
    }

    /// Reads an attribute value, rounded once to `f32`; a value that is not finite (`nan`) becomes
    /// 0.
    ///
    /// # Errors
    /// Errors of [`TextCursor::number`], except for values that are not finite.
    #[inline]
    pub(crate) fn attribute(&mut self, need: &str) -> Result<f32, ParseError> {
        let start = self.at;
        let Some(x) = self.any_number(need)? else {
            self.at += self.here().len();
            return Ok(self.zero());
        };
        let rounded = x as f32;
        if rounds_twice(x) {
            let word = self.bytes[start..self.at].trim_ascii();
            let exact = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
            return Ok(exact.filter(|x: &f32| x.is_finite()).unwrap_or(rounded));
        }
        Ok(if rounded.is_finite() { rounded } else { self.zero() })
    }

    /// Counts an attribute value that is not finite, and returns its replacement.
    #[cold]
    fn zero(&mut self) -> f32 {
        self.not_finite += 1;
        0.0
    }

    /// Returns the number of attribute values read as 0 because they are not finite.
    pub(crate) fn not_finite(&self) -> usize {
        self.not_finite
    }

    /// Reads a finite number; returns `None`, without moving, for NaN and infinities.
    #[inline]
    fn any_number(&mut self, need: &str) -> Result<Option<f64>, ParseError> {
        if !self.more() {
            return Err(self.error(need));
        }
        if let Some((x, end)) = short_number(self.bytes, self.at) {
            self.at = end;
            return Ok(Some(x));
        }
        self.long_number()
    }

    #[cold]
    fn long_number(&mut self) -> Result<Option<f64>, ParseError> {
        let word = self.here();
        let text = std::str::from_utf8(word).unwrap_or("");
        match text.parse::<f64>() {
            Ok(x) if x.is_finite() => {
                self.at += word.len();
                Ok(Some(x))
            }
            Ok(_) => Ok(None),
            // C libraries print -nan, nan(ind) and the like.
            Err(_) if ["nan", "inf"].iter().any(|s| text.to_lowercase().contains(s)) => Ok(None),
            Err(_) => Err(self.refuse("a number")),
        }
    }

    /// Reads an integer, which may be followed directly by any byte that is not a digit.
    ///
    /// # Errors
    /// `need` if the statement ends first; otherwise the word that is not an integer.
    #[inline]
    pub(crate) fn integer(&mut self, need: &str) -> Result<i64, ParseError> {
        if !self.more() {
            return Err(self.error(need));
        }
        let mut at = self.at;
        let negative = self.byte() == b'-';
        at += usize::from(negative || self.byte() == b'+');
        let first = at;
        let mut value = 0_i64;
        while let Some(digit) = digit(self.bytes, at) {
            value = value.wrapping_mul(10).wrapping_add(digit as i64);
            at += 1;
        }
        // 18 digits fit in an i64, and no valid index or count has more.
        if at == first || at - first > 18 {
            return Err(self.refuse("an integer"));
        }
        self.at = at;
        Ok(if negative { -value } else { value })
    }

    /// Moves past `byte` if it is the very next one.
    #[inline]
    pub(crate) fn take(&mut self, byte: u8) -> bool {
        let found = self.at < self.bytes.len() && self.bytes[self.at] == byte;
        self.at += usize::from(found);
        found
    }

    /// Moves past these bytes if they come next, with no blank before them.
    pub(crate) fn take_word(&mut self, word: &[u8]) -> bool {
        let found = self.bytes[self.at..].starts_with(word);
        self.at += if found { word.len() } else { 0 };
        found
    }

    /// Reports whether a digit or a sign comes next.
    pub(crate) fn comes_digit(&self) -> bool {
        self.byte().is_ascii_digit() || matches!(self.byte(), b'-' | b'+')
    }

    /// Reports whether `byte` comes next.
    #[inline]
    pub(crate) fn comes(&self, byte: u8) -> bool {
        self.byte() == byte
    }

    /// Reports whether a blank, a comment, a line end or the end of the text comes next.
    #[inline]
    pub(crate) fn at_blank(&self) -> bool {
        ends_word(self.byte()) || self.continues()
    }

    /// Returns the word that begins at the cursor.
    fn here(&self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(|&b| ends_word(b)).unwrap_or(rest.len());
        let glued = end < rest.len() && is_line_end(rest[end]) && rest[..end].ends_with(b"\\");
        &rest[..end - usize::from(glued)]
    }

    /// Returns the byte at the cursor, or a line end past the last one.
    #[inline]
    fn byte(&self) -> u8 {
        self.bytes.get(self.at).copied().unwrap_or(b'\n')
    }

    /// Reports whether the cursor is at a backslash that ends its line.
    #[inline]
    fn continues(&self) -> bool {
        self.byte() == b'\\' && self.bytes.get(self.at + 1).is_some_and(|&b| is_line_end(b))
    }

    /// Moves past the line end at the cursor, and past a backslash before it.
    #[inline]
    fn end_line(&mut self) {
        self.at += usize::from(self.bytes[self.at] == b'\\');
        let pair = self.bytes[self.at..].starts_with(b"\r\n");
        self.at += 1 + usize::from(pair);
        // The last line end starts no further line.
        self.line += usize::from(self.at < self.bytes.len());
    }
}

/// Decodes bytes as UTF-8 or else, so that nothing is lost, as Latin-1.
pub(crate) fn text_of(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    }
}

/// Formats a word for a message: quoted, shortened, control characters escaped.
pub(crate) fn quoted(word: &[u8]) -> String {
    const MOST: usize = 32;
    let text = String::from_utf8_lossy(&word[..word.len().min(MOST)]);
    let dots = if word.len() > MOST { "…" } else { "" };
    format!("\"{}{dots}\"", text.escape_debug())
}

#[inline]
fn is_line_end(byte: u8) -> bool {
    byte == b'\n' || byte == b'\r'
}

#[inline]
fn ends_word(byte: u8) -> bool {
    byte <= b' ' || byte == b'#'
}

#[inline]
fn digit(bytes: &[u8], at: usize) -> Option<u64> {
    let digit = bytes.get(at)?.wrapping_sub(b'0');
    (digit < 10).then_some(u64::from(digit))
}

/// Powers of ten that `f64` represents exactly.
const TEN_TO: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

/// Parses a number that one exact multiplication or division yields; returns it and its end.
///
/// Digits up to 2^53 and powers of ten up to 22 are both exact, so their product or quotient is
/// rounded once, as it must be. Returns `None` for anything else, including what is not a number.
/// # References
/// [Cli90], section 3.
#[inline]
fn short_number(bytes: &[u8], start: usize) -> Option<(f64, usize)> {
    let sign = *bytes.get(start)?;
    let mut at = start + usize::from(sign == b'-' || sign == b'+');
    let mut digits = 0_u64;
    let first = at;
    while let Some(digit) = digit(bytes, at) {
        digits = digits.wrapping_mul(10).wrapping_add(digit);
        at += 1;
    }
    let mut count = at - first;
    let mut exponent = 0_i32;
    if bytes.get(at) == Some(&b'.') {
        at += 1;
        let point = at;
        while let Some(digit) = digit(bytes, at) {
            digits = digits.wrapping_mul(10).wrapping_add(digit);
            at += 1;
        }
        count += at - point;
        exponent = -((at - point) as i32);
    }
    // 19 digits cannot overflow.
    if count == 0 || count > 19 || digits > 1 << 53 {
        return None;
    }
    if let Some(b'e' | b'E') = bytes.get(at) {
        let (shift, end) = short_exponent(bytes, at + 1)?;
        exponent += shift;
        at = end;
    }
    if bytes.get(at).is_some_and(|&b| !ends_word(b)) {
        return None;
    }
    let size = match exponent {
        0..=22 => digits as f64 * TEN_TO[exponent as usize],
        -22..0 => digits as f64 / TEN_TO[-exponent as usize],
        _ => return None,
    };
    Some((if sign == b'-' { -size } else { size }, at))
}

fn short_exponent(bytes: &[u8], start: usize) -> Option<(i32, usize)> {
    let sign = *bytes.get(start)?;
    let first = start + usize::from(sign == b'-' || sign == b'+');
    let mut at = first;
    let mut value = 0;
    while let Some(digit) = digit(bytes, at) {
        value = value * 10 + digit as i32;
        at += 1;
        if at - first > 4 {
            return None;
        }
    }
    (at > first).then_some((if sign == b'-' { -value } else { value }, at))
}

/// Reports whether rounding `x` to `f32` could differ from rounding the decimal it was parsed from:
/// if `x` lies halfway between two floats, or where `f32` is subnormal.
#[inline]
fn rounds_twice(x: f64) -> bool {
    x.to_bits() & 0x1fff_ffff == 0x1000_0000 || (x != 0.0 && x.abs() < f64::from(f32::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn number(text: &str) -> Result<f64, String> {
        TextCursor::new(text.as_bytes())
            .unwrap()
            .number("missing")
            .map_err(|error| error.to_string())
    }

    #[test]
    fn numbers_come_in_many_forms() {
        let forms = [
            ("1", 1.0),
            ("-2.", -2.0),
            ("+.5", 0.5),
            ("2.e1", 20.0),
            ("1E+2", 100.0),
            ("1e-007", 1e-7),
            ("0.1", 0.1),
            ("123456789012345678901234567890", 123456789012345678901234567890.0),
            ("0.30000000000000004", 0.1 + 0.2),
            ("2.2250738585072014e-308", f64::MIN_POSITIVE),
            ("9007199254740993", 9007199254740993_u64 as f64),
        ];
        for (text, value) in forms {
            assert_eq!(number(text), Ok(value), "{text}");
            assert_eq!(number(&format!(" {text}\\\n")), Ok(value), "{text}");
        }
    }

    #[test]
    fn what_is_no_number_is_named() {
        for (text, reason) in [
            ("3.1+e2", "line 1: \"3.1+e2\" is not a number"),
            ("1,5", "line 1: \"1,5\" is not a number"),
            ("-nan(ind)", "line 1: \"-nan(ind)\" is not a finite number"),
            ("1e999", "line 1: \"1e999\" is not a finite number"),
            ("# 1", "line 1: missing"),
            ("a\u{1}", "line 1: \"a\" is not a number"),
        ] {
            assert_eq!(number(text), Err(reason.to_owned()));
        }
    }

    #[test]
    fn attributes_that_are_not_finite_are_zero() {
        let mut text = TextCursor::new(b"nan -inf 1e300 0.25 -nan(ind) 2").unwrap();
        let values: Vec<f32> = (0..6).map(|_| text.attribute("").unwrap()).collect();
        assert_eq!(values, [0.0, 0.0, 0.0, 0.25, 0.0, 2.0]);
    }

    #[test]
    fn lines_count_with_any_end_and_go_on_after_a_backslash() {
        let mut text = TextCursor::new(b"\xef\xbb\xbfa\r\nb \\\n c\\\r\nd # \\\n\re f").unwrap();
        let mut words = Vec::new();
        loop {
            while text.more() {
                words.push((text.line(), String::from_utf8_lossy(text.word()).into_owned()));
            }
            if !text.next_line() {
                break;
            }
        }
        let expected = [(1, "a"), (2, "b"), (3, "c"), (4, "d"), (6, "e"), (6, "f")];
        assert_eq!(words, expected.map(|(line, word)| (line, word.to_owned())));
    }

    #[test]
    fn what_is_no_text_is_refused() {
        for bytes in [&b""[..], b"\xff\xfev\0", b"\xfe\xff\0v", b"v 1\0"] {
            assert!(TextCursor::new(bytes).is_err());
        }
    }

    proptest! {
        #[test]
        fn numbers_are_rounded_as_the_standard_library_does(
            digits in any::<u64>(), shift in 0_u32..64, exponent in -40_i32..40,
        ) {
            let text = format!("{}e{exponent}", digits >> shift);
            prop_assert_eq!(number(&text).unwrap(), text.parse::<f64>().unwrap());
            let attribute = TextCursor::new(text.as_bytes()).unwrap().attribute("").unwrap();
            let expected = text.parse::<f32>().unwrap();
            prop_assert_eq!(attribute, if expected.is_finite() { expected } else { 0.0 });
        }

        #[test]
        fn written_floats_come_back(x in any::<f64>(), y in any::<f32>()) {
            prop_assume!(x.is_finite() && y.is_finite());
            prop_assert_eq!(number(&format!("{x}")).unwrap(), x);
            prop_assert_eq!(number(&format!("{x:e}")).unwrap(), x);
            let text = format!("{y:e}");
            prop_assert_eq!(TextCursor::new(text.as_bytes()).unwrap().attribute("").unwrap(), y);
        }
    }
}
