//! Random numbers that are the same on every platform.

/// A stream of random bits: splitmix64 [SLF14].
#[derive(Clone, Debug)]
pub(crate) struct Random(u64);

impl Random {
    /// Creates the stream of a seed; `part` selects one of several independent streams.
    pub(crate) fn new(seed: u64, part: u64) -> Self {
        let mut random = Self(seed);
        random.0 = random.bits() ^ part;
        Self(random.bits())
    }

    /// Returns 64 random bits.
    #[inline]
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number below `count`, from 32 of the bits.
    #[inline]
    pub(crate) fn below(&mut self, count: usize) -> usize {
        (((self.bits() >> 32) * count as u64) >> 32) as usize
    }
}
