//! A compressed stream as it is read: from the front, up to its tail.

use thiserror::Error;

/// What is wrong with a compressed stream.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("byte {at}: {reason}")]
pub struct Malformed {
    /// Which byte of the stream.
    pub at: usize,
    /// What is wrong there.
    pub reason: String,
}

impl Malformed {
    pub(super) fn new(at: usize, reason: impl Into<String>) -> Self {
        Self { at, reason: reason.into() }
    }
}

/// The bytes of a stream between its header and its tail.
pub(super) struct Stream<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Stream<'a> {
    /// Splits header byte, body and a tail of so many bytes.
    pub fn split(bytes: &'a [u8], tail: usize) -> Result<(u8, Self, &'a [u8]), Malformed> {
        let Some(end) = bytes.len().checked_sub(tail).filter(|&end| end > 0) else {
            let found = bytes.len();
            let reason = format!("{found} bytes are less than header and tail, {}", tail + 1);
            return Err(Malformed::new(found, reason));
        };
        let (body, tail) = bytes.split_at(end);
        Ok((body[0], Self { bytes: body, at: 1 }, tail))
    }

    pub fn byte(&mut self) -> Result<u8, Malformed> {
        Ok(self.take(1)?[0])
    }

    pub fn take(&mut self, count: usize) -> Result<&'a [u8], Malformed> {
        let rest = &self.bytes[self.at..];
        let Some(taken) = rest.get(..count) else {
            let left = rest.len();
            return Err(self.wrong(format!("{count} bytes should follow, {left} do")));
        };
        self.at += count;
        Ok(taken)
    }

    /// A number of 32 bits, seven a byte, the low ones first; one to five bytes.
    pub fn varint(&mut self) -> Result<u32, Malformed> {
        let mut value = 0u32;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(self.wrong("a number of more than five bytes"))
    }

    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    pub fn finish(&self) -> Result<(), Malformed> {
        match self.left() {
            0 => Ok(()),
            left => Err(self.wrong(format!("{left} bytes too many before the tail"))),
        }
    }

    pub fn wrong(&self, reason: impl Into<String>) -> Malformed {
        Malformed::new(self.at, reason)
    }
}

/// Appends a number as [`Stream::varint`] reads it.
pub(super) fn push_varint(out: &mut Vec<u8>, mut value: u32) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// The difference that a whole number stands for: 0, -1, 1, -2 …
pub(super) fn unzigzag(value: u32) -> u32 {
    (value >> 1) ^ 0u32.wrapping_sub(value & 1)
}

/// A difference as a whole number, small where it is near 0.
pub(super) fn zigzag(difference: u32) -> u32 {
    (difference << 1) ^ ((difference as i32 >> 31) as u32)
}
