//! Numbers of any bit width, packed without gaps.

use crate::bytes::{Malformed, Reader};

/// Bit buffer: numbers are appended, and read at any place.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Bits {
    words: Vec<u64>,
    len: usize,
}

impl Bits {
    /// Appends the low `width` bits of a number, at most 64.
    pub(crate) fn push(&mut self, number: u64, width: u32) {
        debug_assert!(width == 64 || number >> width == 0, "{number} has more than {width} bits");
        if width == 0 {
            return;
        }
        let shift = self.len as u32 % u64::BITS;
        if shift == 0 {
            self.words.push(number);
        } else {
            *self.words.last_mut().expect("it has begun") |= number << shift;
            if shift + width > u64::BITS {
                self.words.push(number >> (u64::BITS - shift));
            }
        }
        self.len += width as usize;
    }

    /// Appends zeros up to a whole byte.
    pub(crate) fn fill_byte(&mut self) {
        self.push(0, (8 - self.len as u32 % 8) % 8);
    }

    /// Returns the number in the `width` bits from `at` on.
    ///
    /// # Panics
    /// If the bits end before.
    #[inline]
    pub(crate) fn get(&self, at: usize, width: u32) -> u64 {
        if width == 0 {
            return 0;
        }
        let (word, shift) = (at / u64::BITS as usize, at as u32 % u64::BITS);
        let mut number = self.words[word] >> shift;
        if shift + width > u64::BITS {
            number |= self.words[word + 1] << (u64::BITS - shift);
        }
        if width < u64::BITS { number & ((1 << width) - 1) } else { number }
    }

    /// Appends the bits to `out`, the last byte filled with zeros.
    pub(crate) fn store(&self, out: &mut Vec<u8>) {
        let end = out.len() + self.len.div_ceil(8);
        out.extend(self.words.iter().flat_map(|word| word.to_le_bytes()));
        out.truncate(end);
    }

    /// Reads `len` bits from bytes.
    pub(crate) fn restore(len: usize, reader: &mut Reader) -> Result<Self, Malformed> {
        let word =
            |bytes: &[u8]| bytes.iter().rev().fold(0, |word, &byte| word << 8 | u64::from(byte));
        Ok(Self { words: reader.take(len.div_ceil(8))?.chunks(8).map(word).collect(), len })
    }

    /// Returns the words, filled from their lowest bits on.
    pub(crate) fn words(&self) -> &[u64] {
        &self.words
    }

    /// Returns the number of bits.
    pub(crate) fn len(&self) -> usize {
        self.len
    }
}

/// Returns how many bits tell `count` values apart.
pub(crate) fn width(count: usize) -> u32 {
    usize::BITS - count.saturating_sub(1).leading_zeros()
}

/// Reader of consecutive numbers that stops at the end.
#[derive(Clone, Debug)]
pub(crate) struct Cursor<'a> {
    bits: &'a Bits,
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(crate) fn new(bits: &'a Bits, at: usize) -> Self {
        Self { bits, at }
    }

    #[inline]
    pub(crate) fn next(&mut self, width: u32) -> Result<u64, Malformed> {
        let end = self.at + width as usize;
        if end > self.bits.len {
            return Err(self.wrong("the bits end early"));
        }
        let number = self.bits.get(self.at, width);
        self.at = end;
        Ok(number)
    }

    /// Returns an error at the current place.
    pub(crate) fn wrong(&self, reason: impl Into<String>) -> Malformed {
        Malformed { at: self.at / 8, reason: reason.into() }
    }
}

/// Reader of consecutive numbers, which takes only as many bytes as it needs.
#[derive(Debug)]
pub(crate) struct BitReader<'r, 'a> {
    reader: &'r mut Reader<'a>,
    /// Bits that were taken from the reader but not asked for yet, and how many.
    held: (u64, u32),
}

impl<'r, 'a> BitReader<'r, 'a> {
    pub(crate) fn new(reader: &'r mut Reader<'a>) -> Self {
        Self { reader, held: (0, 0) }
    }

    /// Reads a number of `width` bits, at most 32.
    pub(crate) fn take(&mut self, width: u32) -> Result<u64, Malformed> {
        let (word, held) = &mut self.held;
        while *held < width {
            *word |= u64::from(self.reader.u8()?) << *held;
            *held += 8;
        }
        let number = *word & ((1 << width) - 1);
        *word >>= width;
        *held -= width;
        Ok(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_all_widths_come_back() {
        let number = |i: u64| i.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let of = |i: u64| {
            let width = (i % 65) as u32;
            (if width == 64 { number(i) } else { number(i) & ((1 << width) - 1) }, width)
        };
        let mut bits = Bits::default();
        (0..500).map(of).for_each(|(number, width)| bits.push(number, width));
        let mut at = 0;
        for (number, width) in (0..500).map(of) {
            assert_eq!(bits.get(at, width), number);
            at += width as usize;
        }
        assert_eq!(bits.len(), at);

        let mut bytes = Vec::new();
        bits.store(&mut bytes);
        assert_eq!(bytes.len(), at.div_ceil(8));
        let mut reader = Reader::new(&bytes);
        assert_eq!(Bits::restore(at, &mut reader), Ok(bits));
        assert!(reader.finish().is_ok() && Bits::restore(1, &mut reader).is_err());
    }

    #[test]
    fn bits_are_read_byte_by_byte() {
        let mut bits = Bits::default();
        let numbers = [(1, 1), (5, 3), (0xfeed, 16), (0, 0), (0xffff_fffe, 32), (1, 2)];
        numbers.iter().for_each(|&(number, width)| bits.push(number, width));
        let mut bytes = Vec::new();
        bits.store(&mut bytes);
        bytes.push(7);
        let mut reader = Reader::new(&bytes);
        let mut taken = BitReader::new(&mut reader);
        for (number, width) in numbers {
            assert_eq!(taken.take(width), Ok(number));
        }
        assert_eq!((reader.u8(), reader.left()), (Ok(7), 0), "no byte too many");
        assert!(BitReader::new(&mut reader).take(1).is_err());
    }
}
