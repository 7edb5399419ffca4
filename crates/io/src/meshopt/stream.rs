//! Cursor over a meshopt stream, from the front up to its tail.

use thiserror::Error;

/// Error in a compressed meshopt stream.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("byte {at}: {reason}")]
pub struct Malformed {
    /// Byte offset of the error in the stream.
    pub at: usize,
    /// Description of the error in the stream.
    pub reason: String,
}

impl Malformed {
    pub(super) fn new(at: usize, reason: impl Into<String>) -> Self {
        Self { at, reason: reason.into() }
    }
}

/// Bytes of a stream between its header and its tail.
pub(super) struct Stream<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Stream<'a> {
    /// Splits a stream into header byte, body and a tail of the given length.
    pub fn split(bytes: &'a [u8], tail: usize) -> Result<(u8, Self, &'a [u8]), Malformed> {
        let Some(end) = bytes.len().checked_sub(tail).filter(|&end| end > 0) else {
            let found = bytes.len();
            let reason =
                format!("{found} bytes are fewer than the {} of header and tail", tail + 1);
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
            return Err(self.wrong(format!("expected {count} more bytes, but only {left} follow")));
        };
        self.at += count;
        Ok(taken)
    }

    /// Reads a 32-bit number in one to five bytes, seven bits each, low bits first.
    pub fn varint(&mut self) -> Result<u32, Malformed> {
        let mut value = 0u32;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err(self.wrong("a variable-length number exceeds five bytes"))
    }

    pub fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    pub fn finish(&self) -> Result<(), Malformed> {
        match self.left() {
            0 => Ok(()),
            left => Err(self.wrong(format!("{left} unexpected bytes before the tail"))),
        }
    }

    pub fn wrong(&self, reason: impl Into<String>) -> Malformed {
        Malformed::new(self.at, reason)
    }
}

/// Appends a number in the form that [`Stream::varint`] reads.
pub(super) fn push_varint(out: &mut Vec<u8>, mut value: u32) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

/// Decodes a zigzag number: 0, -1, 1, -2 …
pub(super) fn unzigzag(value: u32) -> u32 {
    (value >> 1) ^ 0u32.wrapping_sub(value & 1)
}

/// Encodes a difference as a zigzag number, small if it is near 0.
pub(super) fn zigzag(difference: u32) -> u32 {
    (difference << 1) ^ ((difference as i32 >> 31) as u32)
}
