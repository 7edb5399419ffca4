//! The body as a stream of numbers: one reader for text, one for binary of either byte order.

use std::fmt;

use meshlod_mesh::VertexId;

use super::fast;
use super::header::{Element, Header, Scalar, Shape, shown};
use crate::ParseError;

/// Which row is being read, for errors: prints as `vertex 12 of 2903`, counted from 0.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    pub element: &'a Element,
    pub index: u64,
}

impl fmt::Display for Row<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} of {}", shown(&self.element.name), self.index, self.element.count)
    }
}

/// Numbers in the order of the file. A clone reads on from the same place.
pub(super) trait Source: Clone {
    /// To be called before the first number of a row.
    fn begin_row(&mut self);

    /// To be called behind the last number of a row.
    fn end_row(&mut self, row: Row) -> Result<(), ParseError>;

    /// The next number; every type fits `f64` exactly.
    fn number(&mut self, kind: Scalar, row: Row) -> Result<f64, ParseError>;

    /// Passes over so many numbers.
    fn pass(&mut self, kind: Scalar, count: usize, row: Row) -> Result<(), ParseError>;

    /// The most items of a type, or rows of an element, that the rest of the file can hold.
    fn most_items(&self, kind: Scalar) -> usize;
    fn most_rows(&self, element: &Element) -> usize;

    /// An error about the row that was begun last.
    fn wrong(&self, reason: String) -> ParseError;

    /// Takes the first rows in one sweep, as long as they are plain, and gives their number; the
    /// others are left to the careful way, and so are all errors. See [`fast`].
    fn quick_positions(
        &mut self,
        _element: &Element,
        _xyz: [usize; 3],
        _positions: &mut Vec<[f64; 3]>,
    ) -> u64 {
        0
    }

    /// The same for faces.
    fn quick_triangles(
        &mut self,
        _element: &Element,
        _vertices: usize,
        _triangles: &mut Vec<[VertexId; 3]>,
    ) -> u64 {
        0
    }

    /// The length of a list, which the rest of the file can hold.
    fn length(&mut self, length: Scalar, item: Scalar, row: Row) -> Result<usize, ParseError> {
        let claimed = self.number(length, row)?;
        if claimed < 0.0 {
            return Err(self.wrong(format!("{row} has a list of length {claimed}")));
        }
        if claimed > self.most_items(item) as f64 {
            return Err(self.wrong(format!(
                "{row} has a list of {claimed} values, but the file ends before that many"
            )));
        }
        Ok(claimed as usize)
    }

    /// Passes over one property of a row.
    fn pass_property(&mut self, shape: Shape, row: Row) -> Result<(), ParseError> {
        match shape {
            Shape::One(kind) => self.pass(kind, 1, row),
            Shape::List { length, item } => {
                let count = self.length(length, item, row)?;
                self.pass(item, count, row)
            }
        }
    }

    /// Passes over all rows of an element.
    fn skip(&mut self, element: &Element) -> Result<(), ParseError> {
        // Rows of nothing take no bytes: their count alone could keep us for ever.
        let count = if element.properties.is_empty() { 0 } else { element.count };
        for index in 0..count {
            let row = Row { element, index };
            self.begin_row();
            for property in &element.properties {
                self.pass_property(property.shape, row)?;
            }
            self.end_row(row)?;
        }
        Ok(())
    }
}

/// Text: numbers between white space, a row a line. A row may go on over further lines, but two
/// rows never share one, so a missing or surplus number is found where it is.
#[derive(Clone)]
pub(super) struct Text<'a> {
    rest: &'a [u8],
    /// Counted from 1.
    line: usize,
}

impl<'a> Text<'a> {
    pub fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self { rest: &bytes[header.body..], line: header.body_line }
    }

    /// Goes to the next word, over ends of lines.
    fn skip_space(&mut self) {
        while let [first, after @ ..] = self.rest {
            match first {
                b' ' | b'\t' | b'\x0C' => {}
                b'\n' => self.line += 1,
                b'\r' if after.first() == Some(&b'\n') => {}
                b'\r' => self.line += 1,
                _ => break,
            }
            self.rest = after;
        }
    }

    fn word(&mut self, row: Row) -> Result<&'a [u8], ParseError> {
        self.skip_space();
        let end = self.rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        if word.is_empty() {
            return Err(self.wrong(format!("the file ends inside {row}")));
        }
        self.rest = rest;
        Ok(word)
    }
}

impl Source for Text<'_> {
    fn begin_row(&mut self) {
        self.skip_space();
    }

    fn end_row(&mut self, row: Row) -> Result<(), ParseError> {
        let line = self.line;
        self.skip_space();
        if self.line > line || self.rest.is_empty() {
            return Ok(());
        }
        Err(self.wrong(format!(
            "numbers are left over after {row}: this line or the one before it does not fit the \
             properties in the header"
        )))
    }

    fn number(&mut self, kind: Scalar, row: Row) -> Result<f64, ParseError> {
        let word = self.word(row)?;
        parse_number(word, kind).map_err(|reason| {
            let word = shown(&String::from_utf8_lossy(word));
            self.wrong(format!("{row}: \"{word}\" {reason}"))
        })
    }

    fn pass(&mut self, kind: Scalar, count: usize, row: Row) -> Result<(), ParseError> {
        (0..count).try_for_each(|_| self.number(kind, row).map(drop))
    }

    /// A digit and a space each, but for the last.
    fn most_items(&self, _kind: Scalar) -> usize {
        self.rest.len().div_ceil(2)
    }

    fn most_rows(&self, element: &Element) -> usize {
        self.rest.len().div_ceil(2 * element.properties.len().max(1))
    }

    fn wrong(&self, reason: String) -> ParseError {
        ParseError::line(self.line, reason)
    }
}

/// A number of a type, or why it is none.
fn parse_number(word: &[u8], kind: Scalar) -> Result<f64, String> {
    const NOT: &str = "is not a number";
    if let Some(value) = short_whole(word)
        && kind.whole_range().is_none_or(|(least, most)| (least..=most).contains(&value))
    {
        return Ok(value as f64);
    }
    let text = std::str::from_utf8(word).map_err(|_| NOT)?;
    if kind == Scalar::F32 {
        return text.parse::<f32>().map(f64::from).map_err(|_| NOT.into());
    }
    let value: f64 = text.parse().map_err(|_| NOT)?;
    match kind.whole_range() {
        Some((least, most))
            if value.fract() != 0.0 || !(least as f64..=most as f64).contains(&value) =>
        {
            Err(format!("is not a whole number from {least} to {most}"))
        }
        _ => Ok(value),
    }
}

/// A whole number of up to seven digits, exact in every floating type. Indices are read by this,
/// three times as fast as by the general parser.
fn short_whole(word: &[u8]) -> Option<i64> {
    let (sign, digits) = match word {
        // "-0" would lose its sign.
        [b'-', first, ..] if *first != b'0' => (-1, &word[1..]),
        _ => (1, word),
    };
    if digits.is_empty() || digits.len() > 7 {
        return None;
    }
    let mut value = 0;
    for digit in digits {
        value = value * 10 + i64::from(digit.is_ascii_digit().then(|| digit - b'0')?);
    }
    Some(sign * value)
}

/// Binary data; `BIG` is the byte order.
#[derive(Clone)]
pub(super) struct Binary<'a, const BIG: bool> {
    rest: &'a [u8],
    /// Bytes of the whole file.
    total: usize,
    /// Where the row that was begun last begins.
    row_at: usize,
}

impl<'a, const BIG: bool> Binary<'a, BIG> {
    pub fn new(bytes: &'a [u8], header: &Header) -> Self {
        Self { rest: &bytes[header.body..], total: bytes.len(), row_at: header.body }
    }

    /// An error: the file ends within a row.
    fn ended(&self, row: Row) -> ParseError {
        ParseError::byte(self.total, format!("the file ends inside {row}"))
    }

    #[inline]
    fn take<const N: usize>(&mut self, row: Row) -> Result<[u8; N], ParseError> {
        let Some((&raw, rest)) = self.rest.split_first_chunk::<N>() else {
            return Err(self.ended(row));
        };
        self.rest = rest;
        Ok(little::<N, BIG>(raw))
    }
}

/// The bytes of a number in little-endian order.
#[inline]
pub(super) fn little<const N: usize, const BIG: bool>(mut raw: [u8; N]) -> [u8; N] {
    if BIG {
        raw.reverse();
    }
    raw
}

impl<const BIG: bool> Source for Binary<'_, BIG> {
    #[inline]
    fn begin_row(&mut self) {
        self.row_at = self.total - self.rest.len();
    }

    #[inline]
    fn end_row(&mut self, _row: Row) -> Result<(), ParseError> {
        Ok(())
    }

    #[inline]
    fn number(&mut self, kind: Scalar, row: Row) -> Result<f64, ParseError> {
        Ok(match kind {
            Scalar::I8 => i8::from_le_bytes(self.take(row)?).into(),
            Scalar::U8 => u8::from_le_bytes(self.take(row)?).into(),
            Scalar::I16 => i16::from_le_bytes(self.take(row)?).into(),
            Scalar::U16 => u16::from_le_bytes(self.take(row)?).into(),
            Scalar::I32 => i32::from_le_bytes(self.take(row)?).into(),
            Scalar::U32 => u32::from_le_bytes(self.take(row)?).into(),
            Scalar::F32 => f32::from_le_bytes(self.take(row)?).into(),
            Scalar::F64 => f64::from_le_bytes(self.take(row)?),
        })
    }

    fn pass(&mut self, kind: Scalar, count: usize, row: Row) -> Result<(), ParseError> {
        let bytes = count.checked_mul(kind.size()).filter(|&bytes| bytes <= self.rest.len());
        self.rest = &self.rest[bytes.ok_or_else(|| self.ended(row))?..];
        Ok(())
    }

    fn most_items(&self, kind: Scalar) -> usize {
        self.rest.len() / kind.size()
    }

    fn most_rows(&self, element: &Element) -> usize {
        self.rest.len() / element.least_row_size().max(1)
    }

    fn wrong(&self, reason: String) -> ParseError {
        ParseError::byte(self.row_at, reason)
    }

    fn quick_positions(
        &mut self,
        element: &Element,
        xyz: [usize; 3],
        positions: &mut Vec<[f64; 3]>,
    ) -> u64 {
        let rows = fast::positions::<BIG>(self.rest, element, xyz, positions);
        self.rest = &self.rest[rows * element.least_row_size()..];
        rows as u64
    }

    fn quick_triangles(
        &mut self,
        element: &Element,
        vertices: usize,
        triangles: &mut Vec<[VertexId; 3]>,
    ) -> u64 {
        let rows = fast::triangles::<BIG>(self.rest, element, vertices, triangles);
        self.rest = &self.rest[rows * fast::TRIANGLE_ROW..];
        rows as u64
    }
}
