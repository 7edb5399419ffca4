//! Rounding down of many small numbers at once.
// Loops over lanes become vector code, closures over arrays need not; and `clamp` keeps a NaN.
#![allow(clippy::needless_range_loop, clippy::manual_clamp)]

/// Returns the index of the cell that a coordinate falls into, from 0 to `last`; 0 for a NaN.
///
/// A number on the border of two cells may be given to the lower one. `last` must be a whole number
/// below 2²². The compiler turns this into vector code without conversions, which it does not for a
/// cast: near 2²³ a float has no room for a fraction, so its bits are the rounded number.
#[inline(always)]
pub(crate) fn cell_index(x: f32, last: f32) -> u32 {
    const ROUNDER: f32 = (1 << 23) as f32;
    // `max` also replaces a NaN.
    let down = (x - 0.5).max(0.0).min(last);
    (down + ROUNDER).to_bits() & 0x7f_ffff
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_down_and_clamped() {
        let index = |x: f32| cell_index(x, 9.0);
        assert_eq!(
            [0.0, 0.4, 0.99, 1.01, 1.5, 2.49, 8.6, 9.9].map(index),
            [0, 0, 0, 1, 1, 2, 8, 9]
        );
        assert_eq!([-5.0, 1e9, f32::INFINITY, f32::NAN].map(index), [0, 9, 9, 0]);
    }
}
