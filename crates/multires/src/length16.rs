//! Lengths packed into sixteen bits, in stored units.

/// A length in sixteen bits, rounded up: five of exponent, eleven of mantissa, as `f32` has them.
///
/// From 2⁻²⁸ to 16 units it is at most a two-thousandth too long; below, at most 2⁻³⁹ units; above, it
/// is infinite. Codes are in the order of the lengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Length16(pub(crate) u16);

impl Length16 {
    pub(crate) const INFINITE: Self = Self(u16::MAX);
    /// 2⁻²⁸ as `f32`: what code 0 would be were it not taken off, so that code 0 is zero.
    const LEAST: u32 = (127 - 28) << 23;

    #[inline]
    pub(crate) fn get(self) -> f64 {
        if self == Self::INFINITE {
            return f64::INFINITY;
        }
        let shifted = f32::from_bits((u32::from(self.0) << 12) + Self::LEAST);
        f64::from(shifted) - f64::from(f32::from_bits(Self::LEAST))
    }

    /// The least that is no shorter; infinite for NaN.
    pub(crate) fn up(length: f64) -> Self {
        if length <= 0.0 {
            return Self(0);
        }
        // Exact: a double has room for both.
        let shifted = (length + f64::from(f32::from_bits(Self::LEAST))) as f32;
        let steps = shifted.to_bits().saturating_sub(Self::LEAST) >> 12;
        let mut code = Self(u16::try_from(steps).unwrap_or(u16::MAX));
        while code < Self::INFINITE && code.get() < length {
            code.0 += 1;
        }
        code
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_rounded_up_by_little() {
        for i in -2000..500 {
            let length = (f64::from(i) * 0.01).exp2();
            let found = Length16::up(length).get();
            let most = length * (1.0 + 1.0 / 2048.0) + (-39f64).exp2();
            assert!(found >= length, "{length}");
            if length < 15.9 {
                assert!(found <= most, "{length} became {found}");
            } else {
                assert!(found > 15.9);
            }
        }
        assert_eq!(Length16::up(0.0).get(), 0.0);
        assert_eq!(Length16::up(f64::NAN), Length16::INFINITE);
        assert_eq!(Length16::up(1e9).get(), f64::INFINITY);
    }

    #[test]
    fn codes_are_in_order_and_come_back() {
        for code in 0..u16::MAX - 1 {
            assert!(Length16(code).get() < Length16(code + 1).get());
            assert_eq!(Length16::up(Length16(code).get()).0, code);
        }
    }
}
