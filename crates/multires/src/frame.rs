//! The unit in which everything is stored, and lengths of sixteen bits in it.

use glam::{DVec3, Vec3};
use meshlod_mesh::Bounds;

/// Where the mesh is and how large: it is stored about its middle, in a power of two that is at least
/// its diagonal, so that `f32` is as good far from the origin and at any scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    origin: DVec3,
    unit: f64,
    per_unit: f64,
}

/// The smallest unit, 2⁻¹⁰⁰⁰; the largest is its reciprocal.
const SMALLEST: f64 = f64::from_bits((1023 - 1000) << 52);

impl Frame {
    /// The frame of what lies in these bounds.
    pub(crate) fn new(bounds: &Bounds) -> Self {
        if bounds.is_empty() {
            return Self { origin: DVec3::ZERO, unit: 1.0, per_unit: 1.0 };
        }
        let diagonal = diagonal(bounds);
        let unit = if diagonal > 0.0 { diagonal.log2().ceil().exp2() } else { 1.0 };
        // Both ways must be finite. What is smaller or larger still is stored all the same.
        let unit = unit.clamp(SMALLEST, 1.0 / SMALLEST);
        Self { origin: bounds.center().into(), unit, per_unit: 1.0 / unit }
    }

    /// A frame that was written down; none where it cannot have been one.
    pub(crate) fn from_parts(origin: [f64; 3], unit: f64) -> Option<Self> {
        let is_unit = unit.is_normal() && unit > 0.0 && unit.log2().fract() == 0.0;
        let origin = DVec3::from(origin);
        let is_frame = is_unit && (1.0 / unit).is_normal() && origin.is_finite();
        is_frame.then(|| Self { origin, unit, per_unit: 1.0 / unit })
    }

    /// A point of the model as it is stored.
    #[inline]
    pub(crate) fn store(&self, point: DVec3) -> Vec3 {
        self.point(point).as_vec3()
    }

    /// A point of the model in stored units, not yet rounded.
    #[inline]
    pub(crate) fn point(&self, point: DVec3) -> DVec3 {
        // Exact: the unit is a power of two.
        (point - self.origin) * self.per_unit
    }

    /// Whether a stored point is a number in model units.
    pub(crate) fn holds(&self, point: Vec3) -> bool {
        self.model_point(point.as_dvec3()).iter().all(|x| x.is_finite())
    }

    /// A length of the model in stored units.
    #[inline]
    pub(crate) fn length(&self, length: f64) -> f64 {
        length * self.per_unit
    }

    /// A stored length in model units.
    #[inline]
    pub(crate) fn length_of_model(&self, length: f64) -> f64 {
        length * self.unit
    }

    /// A stored point in model units.
    #[inline]
    pub fn model(&self, point: [f32; 3]) -> [f64; 3] {
        self.model_point(Vec3::from(point).as_dvec3())
    }

    /// A point in stored units in model units.
    #[inline]
    pub(crate) fn model_point(&self, point: DVec3) -> [f64; 3] {
        (point * self.unit + self.origin).into()
    }
}

/// That of bounds, also where its square is too large or too small for a number.
fn diagonal(bounds: &Bounds) -> f64 {
    let sides = 0.5 * DVec3::from(bounds.max) - 0.5 * DVec3::from(bounds.min);
    let longest = sides.max_element();
    if longest > 0.0 { 2.0 * longest * (sides / longest).length() } else { 0.0 }
}

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

    #[test]
    fn a_frame_has_the_scale_of_what_is_in_it() {
        for scale in [1e-320, 1e-307, 1e-200, 1e-162, 1.0, 1e154, 1e200, 1e307] {
            let frame = Frame::new(&Bounds { min: [-scale; 3], max: [scale; 3] });
            let stored = frame.store(DVec3::splat(scale));
            assert!(stored.x > 0.0 && stored.x.is_finite(), "{scale}: {stored}");
            let back = frame.model(stored.into())[0];
            assert!((back / scale - 1.0).abs() < 1e-3, "{scale}: {back}");
        }
    }

    #[test]
    fn a_frame_goes_there_and_back() {
        let frame = Frame::new(&Bounds { min: [1e6, 0.0, 0.0], max: [1e6 + 3.0, 1.0, 1.0] });
        let point = DVec3::new(1e6 + 2.125, 0.5, 0.25);
        assert_eq!(frame.model(frame.store(point).into()), point.to_array());
        assert_eq!((frame.length(2.0), frame.length_of_model(0.5)), (0.5, 2.0));
    }
}
