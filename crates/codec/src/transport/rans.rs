//! Symbols of known frequencies as one number, range asymmetric numeral systems [Dud13].
//!
//! The last symbol encoded is the first decoded. Encoding has to start from some state, and decoding ends there: 16 bits that
//! cost nothing, for a checksum.

use crate::bytes::Malformed;

/// The state is below 2³² and at least this.
const LEAST: u32 = 1 << 16;

/// A symbol of those of a table: its part of all, and bits below that are as likely one as the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Symbol {
    /// Where its part begins, and how large it is, of 2^`bits`.
    pub(super) start: u16,
    pub(super) size: u16,
    pub(super) bits: u8,
    pub(super) low_bits: u8,
    pub(super) low: u16,
}

impl Symbol {
    /// One of 2^`bits` that are all as likely, at most 12 bits.
    pub(super) fn uniform(number: u16, bits: u8) -> Self {
        Self { start: number, size: 1, bits, low_bits: 0, low: 0 }
    }
}

/// The bytes of symbols, which are decoded in their order, and of a checksum, which is known by then.
pub(super) fn encode(symbols: &[Symbol], checksum: u16, out: &mut Vec<u8>) {
    let mut state = LEAST | u32::from(checksum);
    let from = out.len();
    for symbol in symbols.iter().rev() {
        let Symbol { start, size, bits, low_bits, low } = *symbol;
        let (start, size) = (u32::from(start), u32::from(size));
        if u64::from(state) >= u64::from(size) << (32 - bits - low_bits) {
            // Read backwards: the greater byte goes first here.
            out.extend((state as u16).to_be_bytes());
            state >>= 16;
        }
        let number = state << low_bits | u32::from(low);
        state = ((number / size) << bits) + start + number % size;
    }
    out.extend(state.to_be_bytes());
    out[from..].reverse();
}

/// What is left of the symbols of a block.
#[derive(Clone, Debug)]
pub(super) struct Symbols<'a> {
    state: u32,
    words: &'a [[u8; 2]],
    at: usize,
}

impl<'a> Symbols<'a> {
    /// From bytes of [`encode`], of an even number that is at least 4.
    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, Malformed> {
        let wrong = || Malformed { at: 0, reason: "no block has these bytes".into() };
        let (state, words) = bytes.split_first_chunk().ok_or_else(wrong)?;
        let (words, rest) = words.as_chunks();
        let state = u32::from_le_bytes(*state);
        if state < LEAST || !rest.is_empty() {
            return Err(wrong());
        }
        Ok(Self { state, words, at: 0 })
    }

    pub(super) fn empty() -> Self {
        Self { state: LEAST, words: &[], at: 0 }
    }

    /// The place of the next symbol in a table of 2^`bits`.
    #[inline(always)]
    pub(super) fn place(&self, bits: u32) -> usize {
        (self.state & ((1 << bits) - 1)) as usize
    }

    /// Passes the next symbol: its size, and by how much its place is offset its start. Gives the bits below.
    #[inline(always)]
    pub(super) fn consume(&mut self, bits: u32, size: u32, offset: u32, low_bits: u32) -> u32 {
        let state = size.wrapping_mul(self.state >> bits).wrapping_add(offset);
        let low = state & ((1 << low_bits) - 1);
        let state = state >> low_bits;
        let word = match self.words.get(self.at) {
            Some(&[low, high]) => u16::from_le_bytes([low, high]),
            None => 0,
        };
        let is_low = state < LEAST;
        self.state = if is_low { state << 16 | u32::from(word) } else { state };
        self.at += usize::from(is_low);
        low
    }

    /// The next number of 2^`bits` that are all as likely, at most 12 bits.
    #[inline]
    pub(super) fn uniform(&mut self, bits: u32) -> u32 {
        self.consume(0, 1, 0, bits)
    }

    /// That all symbols have been passed, with nothing but zeros left, and that what they made has the checksum.
    pub(super) fn finish(&self, checksum: u16) -> Result<(), Malformed> {
        let rest = self.words.get(self.at..).is_some_and(|rest| rest.iter().all(|w| *w == [0; 2]));
        // What a fuzzer makes of a block is to be looked at.
        if cfg!(fuzzing) || (self.state == LEAST | u32::from(checksum) && rest) {
            return Ok(());
        }
        Err(Malformed { at: 0, reason: "a block is damaged: its checksum is another".into() })
    }
}
