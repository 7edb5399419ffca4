//! Buffered output of text formats: lines of words and numbers.

use std::fmt::Write as _;
use std::io::{self, Write};

use crate::precision::Width;

/// Size in bytes above which the buffer is written to `out`.
const PIECE: usize = 1 << 16;

/// Writes lines of words separated by single spaces.
///
/// Numbers are written in the shortest form that reads back as the same `f32` or `f64`. Call
/// [`LineWriter::finish`] at the end to write what is still buffered.
pub(crate) struct LineWriter<'a> {
    out: &'a mut dyn Write,
    width: Width,
    buffer: String,
    at_start: bool,
}

impl<'a> LineWriter<'a> {
    pub(crate) fn new(out: &'a mut dyn Write, width: Width) -> Self {
        Self { out, width, buffer: String::with_capacity(PIECE + 1024), at_start: true }
    }

    /// Appends a word verbatim.
    pub(crate) fn word(&mut self, word: &str) {
        self.blank();
        self.buffer.push_str(word);
    }

    /// Appends a non-negative integer.
    pub(crate) fn integer(&mut self, number: usize) {
        self.blank();
        push_integer(&mut self.buffer, number);
    }

    /// Appends a position in this writer's width; `vertex` is named in the error.
    ///
    /// # Errors
    /// If a coordinate is not finite, or too large for 32 bits.
    pub(crate) fn position(&mut self, vertex: usize, position: [f64; 3]) -> io::Result<()> {
        for x in position {
            self.blank();
            let done = match self.width {
                Width::F32 => push_f32(&mut self.buffer, x as f32),
                Width::F64 => push_f64(&mut self.buffer, x),
            };
            if !done {
                let reason = format!("v{vertex} {}", self.width.reason_not_written());
                return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
            }
        }
        Ok(())
    }

    /// Appends attribute values; a value that is not finite is written as 0.
    pub(crate) fn attributes(&mut self, values: &[f32]) {
        for &x in values {
            self.blank();
            if !push_f32(&mut self.buffer, x) {
                self.buffer.push('0');
            }
        }
    }

    /// Ends the line.
    ///
    /// # Errors
    /// Errors of `out`.
    pub(crate) fn end(&mut self) -> io::Result<()> {
        self.buffer.push('\n');
        self.at_start = true;
        if self.buffer.len() < PIECE { Ok(()) } else { self.flush() }
    }

    /// Writes what is still buffered.
    ///
    /// # Errors
    /// Errors of `out`.
    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.flush()
    }

    /// Appends a mark and a number to the last word, with no space in between.
    pub(crate) fn glue(&mut self, mark: char, number: Option<usize>) {
        self.buffer.push(mark);
        if let Some(number) = number {
            push_integer(&mut self.buffer, number);
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.write_all(self.buffer.as_bytes())?;
        self.buffer.clear();
        Ok(())
    }

    fn blank(&mut self) {
        if !std::mem::take(&mut self.at_start) {
            self.buffer.push(' ');
        }
    }
}

impl Width {
    /// Reason given for a coordinate that cannot be written in this width.
    fn reason_not_written(self) -> &'static str {
        match self {
            Self::F32 => {
                "does not fit in 32-bit floats; write with 64 bits, or scale the model down"
            }
            Self::F64 => "has a coordinate that is not finite",
        }
    }
}

fn push_integer(buffer: &mut String, number: usize) {
    // Formatting into a string cannot fail.
    let _ = write!(buffer, "{number}");
}

/// Appends a float; if it is not finite, appends nothing and returns false.
fn push_f32(buffer: &mut String, x: f32) -> bool {
    let plain = x == 0.0 || (1e-5..1e9).contains(&x.abs());
    let _ = match (plain, x.is_finite()) {
        (true, _) => write!(buffer, "{x}"),
        (false, true) => write!(buffer, "{x:e}"),
        (false, false) => return false,
    };
    true
}

/// Appends a double; if it is not finite, appends nothing and returns false.
fn push_f64(buffer: &mut String, x: f64) -> bool {
    let plain = x == 0.0 || (1e-5..1e17).contains(&x.abs());
    let _ = match (plain, x.is_finite()) {
        (true, _) => write!(buffer, "{x}"),
        (false, true) => write!(buffer, "{x:e}"),
        (false, false) => return false,
    };
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(width: Width, position: [f64; 3]) -> Result<String, String> {
        let mut out = Vec::new();
        let mut lines = LineWriter::new(&mut out, width);
        lines.word("v");
        lines.position(7, position).map_err(|error| error.to_string())?;
        lines.end().unwrap();
        lines.finish().unwrap();
        Ok(String::from_utf8(out).unwrap())
    }

    #[test]
    fn numbers_are_as_short_as_their_precision_allows() {
        let position = [0.1, -1e-20, 16777217.0];
        assert_eq!(written(Width::F32, position).unwrap(), "v 0.1 -1e-20 16777216\n");
        assert_eq!(written(Width::F64, position).unwrap(), "v 0.1 -1e-20 16777217\n");
        let third = [1.0 / 3.0, -0.0, 1e300];
        assert_eq!(written(Width::F64, third).unwrap(), "v 0.3333333333333333 -0 1e300\n");
    }

    #[test]
    fn what_does_not_fit_is_refused_by_name() {
        let message = written(Width::F32, [0.0, 1e300, 0.0]).unwrap_err();
        assert!(message.starts_with("v7 does not fit in 32-bit floats"), "{message}");
        assert!(written(Width::F64, [f64::NAN, 0.0, 0.0]).is_err());
    }
}
