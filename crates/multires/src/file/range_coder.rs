//! Adaptive binary range coding [Mar79] of numbers, with the mean of two models for each bit.

/// Probability that a bit is set, learnt from those seen so far: 16 bits and their number.
#[derive(Clone, Copy, Debug)]
pub(super) struct BitModel {
    probability: u16,
    seen: u8,
}

/// Number of bits after which a model learns at a constant rate. Not tuned: a chunk has some
/// thousand bits for each model in use.
const MOST_SEEN: u8 = 120;
/// Minimum probability, in units of 2⁻¹⁶, so that no bit is impossible.
const MIN_PROBABILITY: u32 = 64;

/// Learning rate of a model, 2 / (2 n + 3) after n bits, rounded up in 2^-40: products with numbers
/// of 16 bits are rounded down as quotients are.
const RATES: [u64; MOST_SEEN as usize + 1] = {
    let (mut all, mut seen) = ([0; MOST_SEEN as usize + 1], 0);
    while seen < all.len() {
        all[seen] = (2u64 << RATE_BITS).div_ceil(2 * seen as u64 + 3);
        seen += 1;
    }
    all
};
const RATE_BITS: u32 = 40;

impl Default for BitModel {
    fn default() -> Self {
        Self { probability: 1 << 15, seen: 0 }
    }
}

impl BitModel {
    fn learn(&mut self, bit: bool) {
        let target = if bit { i32::from(u16::MAX) } else { 0 };
        let apart = target - i32::from(self.probability);
        let rated = u64::from(apart.unsigned_abs()) * RATES[usize::from(self.seen)];
        let step = (rated >> RATE_BITS) as i32;
        self.probability = (i32::from(self.probability) + if bit { step } else { -step }) as u16;
        self.seen += u8::from(self.seen < MOST_SEEN);
    }
}

/// Returns the probability of a set bit by both models, of 2¹⁶.
fn mean(models: [&BitModel; 2]) -> u32 {
    let [a, b] = models.map(|model| u32::from(model.probability));
    ((a + b) / 2).clamp(MIN_PROBABILITY, (1 << 16) - MIN_PROBABILITY)
}

/// Coder of bits in either direction, so that encoder and decoder share their models' code.
pub(super) trait BitCoder {
    /// Codes a bit, which a decoder ignores, and returns it.
    fn bit(&mut self, bit: bool, models: [&mut BitModel; 2]) -> bool;
    /// Codes the lowest bits of a number, all equally likely.
    fn plain(&mut self, number: u32, bits: u32) -> u32;
}

/// Writes bits.
pub(super) struct Encoder {
    low: u64,
    range: u32,
    /// Byte not written yet, as it may still be carried into, and the number of 0xFF after it.
    held: Option<u8>,
    full: usize,
    bytes: Vec<u8>,
}

impl Encoder {
    pub(super) fn new() -> Self {
        Self { low: 0, range: u32::MAX, held: None, full: 0, bytes: Vec::new() }
    }

    fn shift(&mut self) {
        if self.low < 0xFF00_0000 || self.low > u64::from(u32::MAX) {
            let carry = (self.low >> 32) as u8;
            self.bytes.extend(self.held.map(|held| held.wrapping_add(carry)));
            self.bytes.extend(std::iter::repeat_n(0xFFu8.wrapping_add(carry), self.full));
            self.full = 0;
            self.held = Some((self.low >> 24) as u8);
        } else {
            self.full += 1;
        }
        self.low = (self.low & 0x00FF_FFFF) << 8;
    }

    fn narrow(&mut self, start: u32, range: u32) {
        self.low += u64::from(start);
        self.range = range;
        while self.range < 1 << 24 {
            self.range <<= 8;
            self.shift();
        }
    }

    /// Returns all bytes but zeros at the end, which a decoder assumes.
    pub(super) fn finish(mut self) -> Vec<u8> {
        // Of the numbers in the interval one whose lower bytes are zero is the shortest.
        let last = self.low + u64::from(self.range) - 1;
        let bits = (0..=32).rev().find(|&bits| (last >> bits) << bits >= self.low);
        self.low = (last >> bits.unwrap_or(0)) << bits.unwrap_or(0);
        (0..5).for_each(|_| self.shift());
        while self.bytes.last() == Some(&0) {
            self.bytes.pop();
        }
        self.bytes
    }
}

impl BitCoder for Encoder {
    fn bit(&mut self, bit: bool, [a, b]: [&mut BitModel; 2]) -> bool {
        let split = (self.range >> 16) * mean([a, b]);
        if bit {
            self.narrow(0, split)
        } else {
            self.narrow(split, self.range - split)
        }
        a.learn(bit);
        b.learn(bit);
        bit
    }

    fn plain(&mut self, number: u32, bits: u32) -> u32 {
        for bit in (0..bits).rev() {
            let half = self.range >> 1;
            let start = if number >> bit & 1 == 1 { half } else { 0 };
            self.narrow(start, half);
        }
        number
    }
}

/// Reads bits, and zeros behind the end.
pub(super) struct Decoder<'b> {
    bytes: &'b [u8],
    at: usize,
    range: u32,
    code: u32,
}

impl<'b> Decoder<'b> {
    pub(super) fn new(bytes: &'b [u8]) -> Self {
        let mut this = Self { bytes, at: 0, range: u32::MAX, code: 0 };
        (0..4).for_each(|_| this.next_byte());
        this
    }

    fn next_byte(&mut self) {
        self.code = self.code << 8 | u32::from(self.bytes.get(self.at).copied().unwrap_or(0));
        self.at += 1;
    }

    fn narrow(&mut self, start: u32, range: u32) {
        self.code -= start;
        self.range = range;
        while self.range < 1 << 24 {
            self.range <<= 8;
            self.next_byte();
        }
    }

    /// Returns true if no bytes are left.
    pub(super) fn is_at_end(&self) -> bool {
        self.at >= self.bytes.len()
    }
}

impl BitCoder for Decoder<'_> {
    fn bit(&mut self, _: bool, [a, b]: [&mut BitModel; 2]) -> bool {
        let split = (self.range >> 16) * mean([a, b]);
        let bit = self.code < split;
        if bit {
            self.narrow(0, split)
        } else {
            self.narrow(split, self.range - split)
        }
        a.learn(bit);
        b.learn(bit);
        bit
    }

    fn plain(&mut self, _: u32, bits: u32) -> u32 {
        let mut number = 0;
        for _ in 0..bits {
            let half = self.range >> 1;
            let bit = self.code >= half;
            // The last number of an odd range is never written.
            self.code = self.code.min(2 * half - 1);
            self.narrow(if bit { half } else { 0 }, half);
            number = number << 1 | u32::from(bit);
        }
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits(coder: &mut impl BitCoder, wanted: &[bool]) -> Vec<bool> {
        let mut models = [[BitModel::default(); 2]; 3];
        let code = |(i, &bit): (usize, &bool)| {
            let [a, b] = &mut models[i % 3];
            let bit = coder.bit(bit, [a, b]);
            coder.plain(u32::from(bit) * 5, 3) == 5 && bit
        };
        wanted.iter().enumerate().map(code).collect()
    }

    #[test]
    fn bits_come_back_and_rare_ones_are_paid_for() {
        let rare = |part: u32| move |i: u32| i.wrapping_mul(2_654_435_761) >> 16 < 65_536 / part;
        for part in [1, 2, 7, 300, 70_000] {
            let wanted: Vec<bool> = (0..3000).map(rare(part)).collect();
            let mut encoder = Encoder::new();
            bits(&mut encoder, &wanted);
            let bytes = encoder.finish();
            let mut decoder = Decoder::new(&bytes);
            assert_eq!(bits(&mut decoder, &vec![false; 3000]), wanted, "{part}");
            assert!(decoder.is_at_end());
            let model = bytes.len() - (3000 * 3) / 8;
            assert!(model < if part == 2 || part == 7 { 400 } else { 60 }, "{part}: {model}");
        }
    }

    #[test]
    fn rates_are_quotients() {
        for (seen, rate) in (0..).zip(RATES) {
            for apart in 0..1u64 << 16 {
                let quotient = 2 * apart / (2 * seen + 3);
                assert_eq!((apart * rate) >> RATE_BITS, quotient, "{seen} {apart}");
            }
        }
    }

    #[test]
    fn any_bytes_are_bits() {
        for seed in 0..200u32 {
            let bytes: Vec<u8> = (0..seed)
                .map(|i| (i * seed).wrapping_mul(2_654_435_761).to_be_bytes()[0])
                .collect();
            bits(&mut Decoder::new(&bytes), &[false; 500]);
            bits(&mut Decoder::new(&[0xFF; 40]), &[false; 500]);
        }
    }
}
