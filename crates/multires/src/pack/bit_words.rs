//! Numbers of any width in a string of bits.

/// Bits of a word. A string of bits starts at the lowest bit of the first word.
pub(super) const WORD: usize = u64::BITS as usize;

/// Returns the minimum and the maximum, or zeros for an empty list.
pub(super) fn range(numbers: impl Iterator<Item = i32>) -> [i32; 2] {
    let grown = |[least, most]: [i32; 2], x: i32| [least.min(x), most.max(x)];
    let range = numbers.fold([i32::MAX, i32::MIN], grown);
    if range[0] > range[1] { [0; 2] } else { range }
}

/// Returns the bits that the numbers of a range take, counted from the least one.
pub(super) fn bits_of(least: i32, most: i32) -> u32 {
    u32::BITS - (most.wrapping_sub(least) as u32).leading_zeros()
}

/// Writes a number from a bit on, where there are zeros, into two words that must be there.
pub(super) fn put(words: &mut [u64], at: usize, number: u32) {
    let (word, shift) = (at / WORD, at % WORD);
    words[word] |= u64::from(number) << shift;
    words[word + 1] |= u64::from(number) >> 1 >> (WORD - 1 - shift);
}

/// Returns the number of so many bits, at most 32, from a bit on, out of two words that must be there.
#[inline]
pub(super) fn number_at(words: &[u64], at: usize, bits: u32) -> u32 {
    let (word, shift) = (at / WORD, at % WORD);
    // Shifted in two steps, as a word cannot be shifted by all of its bits.
    let all = words[word] >> shift | words[word + 1] << 1 << (WORD - 1 - shift);
    (all & ((1 << bits) - 1)) as u32
}
