//! Little-endian numbers from untrusted bytes.

use thiserror::Error;

/// Error: the bytes to be decoded are damaged, incomplete or in another format.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("byte {at}: {reason}")]
pub struct Malformed {
    /// Byte offset at which the error was found.
    pub at: usize,
    /// Description of what is wrong with the bytes.
    pub reason: String,
}

/// Returns the fraction by which `bytes` is less than three `f32` per vertex; 0 for no vertices.
pub(crate) fn reduction(bytes: usize, vertices: usize) -> f64 {
    match vertices {
        0 => 0.0,
        count => 1.0 - bytes as f64 / (12 * count) as f64,
    }
}

/// Reader of consecutive bytes that stops at the end.
#[derive(Clone, Debug)]
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

macro_rules! numbers {
    ($($name:ident),*) => {$(
        pub(crate) fn $name(&mut self) -> Result<$name, Malformed> {
            let bytes = self.take(size_of::<$name>())?;
            Ok($name::from_le_bytes(bytes.try_into().expect("as many as were taken")))
        }
    )*};
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    numbers!(u8, u16, u32, u64, i32, f32, f64);

    /// Takes the next `count` bytes.
    pub(crate) fn take(&mut self, count: usize) -> Result<&'a [u8], Malformed> {
        let rest = &self.bytes[self.at..];
        let Some(taken) = rest.get(..count) else {
            return Err(self.wrong(format!("expected {count} more bytes, found {}", rest.len())));
        };
        self.at += count;
        Ok(taken)
    }

    /// Takes the next bytes as a reader of their own, which reports errors at their true offset.
    pub(crate) fn section(&mut self, len: usize) -> Result<Reader<'a>, Malformed> {
        let at = self.at;
        self.take(len)?;
        Ok(Reader { bytes: &self.bytes[..self.at], at })
    }

    /// Returns all remaining bytes.
    pub(crate) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// Returns the number of remaining bytes, by which claimed counts can be checked.
    pub(crate) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Checks that nothing is left.
    pub(crate) fn finish(&self) -> Result<(), Malformed> {
        match self.left() {
            0 => Ok(()),
            left => Err(self.wrong(format!("{left} unexpected bytes at the end"))),
        }
    }

    /// Returns an error at the current place.
    pub(crate) fn wrong(&self, reason: impl Into<String>) -> Malformed {
        Malformed { at: self.at, reason: reason.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_read_past_the_end() {
        let mut reader = Reader::new(&[1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(reader.u8(), Ok(1));
        assert_eq!(reader.u32(), Ok(0x0504_0302));
        assert_eq!(reader.u32().unwrap_err().at, 5);
        assert_eq!(
            reader.finish().unwrap_err().to_string(),
            "byte 5: 2 unexpected bytes at the end"
        );
        assert_eq!(reader.take(usize::MAX).unwrap_err().at, 5);
        assert_eq!(reader.u16(), Ok(0x0706));
        assert_eq!((reader.left(), reader.finish()), (0, Ok(())));
    }
}
