//! Small numbers of block headers, stored as offsets from a common minimum.

/// Range of a header field: its minimum, and the number of bits that offsets from it take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct HeaderField {
    pub(crate) least: u8,
    pub(crate) bits: u32,
}

impl HeaderField {
    /// Returns the narrowest field that holds all of these numbers and none above 255.
    pub(crate) fn covering(numbers: impl Iterator<Item = u8> + Clone) -> Self {
        let least = numbers.clone().min().unwrap_or(0);
        let most = numbers.max().unwrap_or(0);
        let bits = u8::BITS - (most - least).leading_zeros();
        Self { least: least.min((256 - (1 << bits)) as u8), bits }
    }

    /// Returns true if every number of the field fits in a byte.
    pub(crate) fn is_valid(self) -> bool {
        self.bits <= u8::BITS && u32::from(self.least) + (1 << self.bits) <= 256
    }
}
