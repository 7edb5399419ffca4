//! Entropy coding by range asymmetric numeral systems [Dud13].
//!
//! The last symbol encoded is the first decoded. The encoder must start from some state, and the
//! decoder ends in it, so 16 of its bits hold a checksum for free.

use crate::bytes::Malformed;

/// Minimum state between symbols; states are below 2³².
const MIN_STATE: u32 = 1 << 16;

/// Symbol of a table: its share, and equally likely bits below it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Symbol {
    /// Start and size of its share, of 2^`bits`.
    pub(super) start: u16,
    pub(super) size: u16,
    pub(super) bits: u8,
    pub(super) low_bits: u8,
    pub(super) low: u16,
}

impl Symbol {
    /// Returns one of 2^`bits` equally likely numbers, for at most 12 bits.
    pub(super) fn uniform(number: u16, bits: u8) -> Self {
        Self { start: number, size: 1, bits, low_bits: 0, low: 0 }
    }
}

/// Encodes symbols, to be decoded in the same order, and a checksum that the decoder knows by then.
pub(super) fn encode(symbols: &[Symbol], checksum: u16, out: &mut Vec<u8>) {
    let mut state = MIN_STATE | u32::from(checksum);
    let from = out.len();
    for symbol in symbols.iter().rev() {
        let Symbol { start, size, bits, low_bits, low } = *symbol;
        let (start, size) = (u32::from(start), u32::from(size));
        if u64::from(state) >= u64::from(size) << (32 - bits - low_bits) {
            // All bytes are reversed below, so big-endian becomes little-endian.
            out.extend((state as u16).to_be_bytes());
            state >>= 16;
        }
        let number = state << low_bits | u32::from(low);
        state = ((number / size) << bits) + start + number % size;
    }
    out.extend(state.to_be_bytes());
    out[from..].reverse();
}

/// Reader of the symbols of a block.
#[derive(Clone, Debug)]
pub(super) struct Symbols<'a> {
    state: u32,
    words: &'a [[u8; 2]],
    at: usize,
}

impl<'a> Symbols<'a> {
    /// Starts reading bytes from [`encode`]. They must be an even number of at least four.
    pub(super) fn new(bytes: &'a [u8]) -> Result<Self, Malformed> {
        let wrong =
            || Malformed { at: 0, reason: "the bytes of a block have no valid coder state".into() };
        let (state, words) = bytes.split_first_chunk().ok_or_else(wrong)?;
        let (words, rest) = words.as_chunks();
        let state = u32::from_le_bytes(*state);
        if state < MIN_STATE || !rest.is_empty() {
            return Err(wrong());
        }
        Ok(Self { state, words, at: 0 })
    }

    pub(super) fn empty() -> Self {
        Self { state: MIN_STATE, words: &[], at: 0 }
    }

    /// Returns the slot of the next symbol in a table of 2^`bits`.
    #[inline(always)]
    pub(super) fn place(&self, bits: u32) -> usize {
        (self.state & ((1 << bits) - 1)) as usize
    }

    /// Consumes the next symbol, given its size and the slot's offset from its start. Returns its
    /// low bits.
    #[inline(always)]
    pub(super) fn consume(&mut self, bits: u32, size: u32, offset: u32, low_bits: u32) -> u32 {
        let state = size.wrapping_mul(self.state >> bits).wrapping_add(offset);
        let low = state & ((1 << low_bits) - 1);
        let state = state >> low_bits;
        let word = match self.words.get(self.at) {
            Some(&[low, high]) => u16::from_le_bytes([low, high]),
            None => 0,
        };
        let is_low = state < MIN_STATE;
        self.state = if is_low { state << 16 | u32::from(word) } else { state };
        self.at += usize::from(is_low);
        low
    }

    /// Reads one of 2^`bits` equally likely numbers, for at most 12 bits.
    #[inline]
    pub(super) fn uniform(&mut self, bits: u32) -> u32 {
        self.consume(0, 1, 0, bits)
    }

    /// Checks that all symbols are read, that only zeros are left, and that the checksum matches.
    pub(super) fn finish(&self, checksum: u16) -> Result<(), Malformed> {
        let rest = self.words.get(self.at..).is_some_and(|rest| rest.iter().all(|w| *w == [0; 2]));
        // Let a fuzzer sharing what follows.
        if cfg!(fuzzing) || (self.state == MIN_STATE | u32::from(checksum) && rest) {
            return Ok(());
        }
        Err(Malformed { at: 0, reason: "a block is damaged: its checksum does not match".into() })
    }
}
