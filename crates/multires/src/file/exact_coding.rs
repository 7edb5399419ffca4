//! Lossless coding of `f64` positions: each coordinate as its distance from a prediction, counted
//! in representable numbers.
//!
//! Trailing bits that are zero in all coordinates of a list are left out of the count, so values
//! that were single precision once are counted in steps of that.

use std::io;

use super::streams::{Packer, Unpacker};
use crate::pack::{unzigzag, zigzag};

/// Distances of positions from their predictions, by axis.
pub(super) struct Deltas([AxisDeltas; 3]);

struct AxisDeltas {
    /// Number of trailing bits that are zero in every coordinate of this axis.
    zero_bits: u8,
    deltas: Vec<i64>,
}

/// All bits of an `f64` but its sign.
const MAGNITUDE: i64 = i64::MAX;

/// Encodes pairs of an exact position and its prediction.
pub(super) fn write(pairs: &[[[f64; 3]; 2]], packer: &mut Packer) -> io::Result<()> {
    for k in 0..3 {
        // The shift drops the sign bit; 0 has 63 zero bits.
        let zeros = pairs.iter().map(|[exact, _]| (exact[k].to_bits() << 1).trailing_zeros());
        let zero_bits = zeros.min().map_or(0, |zeros| zeros - 1) as u8;
        packer.bytes(&[zero_bits])?;
        let step = |[exact, guess]: &[[f64; 3]; 2]| {
            zigzag(ordinal(exact[k], zero_bits).wrapping_sub(ordinal(guess[k], zero_bits)))
        };
        packer.numbers(&pairs.iter().map(step).collect::<Vec<u64>>())?;
    }
    Ok(())
}

impl Deltas {
    /// Decodes the deltas of `count` positions.
    pub(super) fn read(count: usize, input: &mut Unpacker<'_>) -> io::Result<Self> {
        let mut axis = || {
            let zero_bits = input.bytes(1)?[0];
            if u32::from(zero_bits) >= i64::BITS {
                return Err(io::Error::from(io::ErrorKind::InvalidData));
            }
            let deltas = input.numbers(count)?;
            Ok(AxisDeltas { zero_bits, deltas: deltas.into_iter().map(unzigzag).collect() })
        };
        Ok(Self([axis()?, axis()?, axis()?]))
    }

    /// Returns the position at index `at`, given its prediction, or `None` if it is not finite.
    pub(super) fn position(&self, at: usize, guess: [f64; 3]) -> Option<[f64; 3]> {
        let coordinate = |k: usize| {
            let AxisDeltas { zero_bits, deltas } = &self.0[k];
            from_ordinal(ordinal(guess[k], *zero_bits).wrapping_add(deltas[at]), *zero_bits)
        };
        Some([coordinate(0)?, coordinate(1)?, coordinate(2)?])
    }
}

/// Rank of a number among those with the given number of trailing zero bits, rounding towards 0.
/// Negative numbers, −0 included, have the ranks from −1 down.
fn ordinal(x: f64, zero_bits: u8) -> i64 {
    let bits = x.to_bits() as i64;
    let magnitude = (bits & MAGNITUDE) >> zero_bits;
    if bits < 0 { !magnitude } else { magnitude }
}

/// Returns the number of a given rank, or `None` if no finite number has it.
fn from_ordinal(rank: i64, zero_bits: u8) -> Option<f64> {
    let (magnitude, sign) = if rank < 0 { (!rank, !MAGNITUDE) } else { (rank, 0) };
    let is_there = magnitude <= MAGNITUDE >> zero_bits;
    let x = f64::from_bits(((magnitude << zero_bits) | sign) as u64);
    (is_there && x.is_finite()).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn there_and_back(pairs: &[[[f64; 3]; 2]]) -> usize {
        let mut packer = Packer::new().unwrap();
        write(pairs, &mut packer).unwrap();
        let bytes = packer.finish().unwrap();
        let deltas = Deltas::read(pairs.len(), &mut Unpacker::new(&bytes).unwrap()).unwrap();
        for (at, [exact, guess]) in pairs.iter().enumerate() {
            let read = deltas.position(at, *guess).unwrap();
            assert_eq!(read.map(f64::to_bits), exact.map(f64::to_bits));
        }
        bytes.len()
    }

    #[test]
    fn every_number_comes_back_to_the_bit() {
        let least = f64::from_bits(1);
        let all = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            least,
            -least,
            f64::MIN_POSITIVE,
            f64::MAX,
            f64::MIN,
            0.1,
            -1e6,
            500_000.123,
        ];
        let guesses = [0.0, -0.0, 1e300, -1e-300, 500_000.1];
        let pairs = all.iter().flat_map(|&x| guesses.map(|guess| [[x, -x, x], [guess, x, -x]]));
        let pairs: Vec<_> = pairs.collect();
        there_and_back(&pairs);
        pairs.iter().for_each(|pair| _ = there_and_back(&[*pair]));
        there_and_back(&[]);
        there_and_back(&[[[0.0, -0.0, 0.0], [1.5, 2.5, -1.5]]]);
    }

    #[test]
    fn what_was_single_takes_less_room() {
        let of = |x: fn(f64) -> f64| {
            let guess = |i: u32| f64::from(i).sqrt() * (1.0 + 1e-7 * f64::from(i % 97));
            let pair = |i: u32| [[x(f64::from(i).sqrt()); 3], [guess(i); 3]];
            there_and_back(&(1..2000).map(pair).collect::<Vec<_>>())
        };
        let (doubles, singles) = (of(|x| x), of(|x| f64::from(x as f32)));
        assert!(2 * singles < doubles, "{singles} of {doubles}");
    }

    #[test]
    fn what_is_no_number_is_refused() {
        let inf = ordinal(f64::INFINITY, 0);
        assert_eq!((from_ordinal(inf - 1, 0), from_ordinal(inf, 0)), (Some(f64::MAX), None));
        assert_eq!(
            (from_ordinal(!inf, 0), from_ordinal(i64::MAX, 0), from_ordinal(i64::MIN, 0)),
            (None, None, None)
        );
        assert_eq!((from_ordinal(i64::MAX, 29), from_ordinal(1 << 34, 29)), (None, None));
        assert_eq!(from_ordinal(ordinal(-1.5, 29), 29), Some(-1.5));
    }
}
