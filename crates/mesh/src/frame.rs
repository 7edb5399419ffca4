//! Local coordinate systems that bring a mesh near the origin, to a size near one.

use glam::DVec3;

use crate::Bounds;

/// Local coordinate system: an origin and a unit of length that is a power of two.
///
/// Dividing by such a unit rounds nothing. In a frame that fits it, a mesh that is far from the
/// origin, or extremely large or small, keeps the precision of `f32`, and fourth powers of its
/// lengths stay within the range of `f64`.
///
/// ```
/// use meshlod_mesh::{Bounds, Frame};
///
/// let frame = Frame::of(&Bounds { min: [1e6; 3], max: [1e6 + 3.0; 3] });
/// let point = [1e6 + 2.75; 3];
/// assert_eq!(frame.local(point), [1.25; 3].into());
/// assert_eq!(frame.model(frame.local(point)), point);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    origin: DVec3,
    unit: f64,
    scale: f64,
}

/// Greatest exponent of a unit whose reciprocal is a normal number too.
const MAX_EXPONENT: i32 = 1022;
/// Greatest exponent of the unit of [`Frame::of_diagonal`]: the largest boxes that `f64` holds
/// still map to finite coordinates, and back.
const MAX_DIAGONAL_EXPONENT: f64 = 1000.0;

impl Frame {
    /// Creates a coordinate system with a unit of 2^`exponent` model units; exponents beyond ±1022
    /// are clamped.
    pub fn new(origin: impl Into<DVec3>, exponent: i32) -> Self {
        let exponent = exponent.clamp(-MAX_EXPONENT, MAX_EXPONENT);
        let [unit, scale] = [exponent, -exponent].map(|exponent| 2f64.powi(exponent));
        Self { origin: origin.into(), unit, scale }
    }

    /// Creates a coordinate system from an origin and a unit, such as read from a file.
    ///
    /// Returns `None` unless the origin is finite and the unit is a power of two whose reciprocal
    /// is normal too.
    pub fn from_unit(origin: impl Into<DVec3>, unit: f64) -> Option<Self> {
        let (origin, scale) = (origin.into(), 1.0 / unit);
        let is_power = unit.is_normal() && unit > 0.0 && unit.log2().fract() == 0.0;
        let fits = is_power && scale.is_normal() && origin.is_finite();
        fits.then_some(Self { origin, unit, scale })
    }

    /// Creates a coordinate system around the center of a box, with half of its longest side 1 to 2
    /// units long.
    ///
    /// It can be up to 4 units at the very end of the range of `f64`. The box must be finite; one
    /// without extent keeps the model's unit.
    pub fn of(bounds: &Bounds) -> Self {
        let half = half_sides(bounds).max_element();
        let exponent = if half > 0.0 { half.log2().floor() } else { 0.0 };
        Self::new(bounds.center(), exponent as i32)
    }

    /// Creates a coordinate system around the center of a box, with the smallest unit not below the
    /// length of the box's diagonal.
    ///
    /// The unit is at least 2⁻¹⁰⁰⁰ and at most 2¹⁰⁰⁰. A box without extent keeps the model's unit.
    pub fn of_diagonal(bounds: &Bounds) -> Self {
        let sides = half_sides(bounds);
        let longest = sides.max_element();
        // Scaled, so that the squares of very long or short sides stay in range.
        let diagonal = if longest > 0.0 { 2.0 * longest * (sides / longest).length() } else { 0.0 };
        let exponent = if diagonal > 0.0 { diagonal.log2().ceil() } else { 0.0 };
        let most = MAX_DIAGONAL_EXPONENT;
        Self::new(bounds.center(), exponent.clamp(-most, most) as i32)
    }

    /// Returns the length of the local unit in model units, a power of two.
    #[inline]
    pub fn unit(&self) -> f64 {
        self.unit
    }

    /// Returns the number of local units per model unit, the reciprocal of [`Frame::unit`] and also
    /// a power of two.
    #[inline]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Converts a point from model coordinates to local coordinates.
    #[inline]
    pub fn local(&self, point: impl Into<DVec3>) -> DVec3 {
        (point.into() - self.origin) * self.scale
    }

    /// Converts a point from local coordinates to model coordinates.
    #[inline]
    pub fn model(&self, local: impl Into<DVec3>) -> [f64; 3] {
        (local.into() * self.unit + self.origin).into()
    }

    /// Converts a length from model units to local units.
    #[inline]
    pub fn local_length(&self, length: f64) -> f64 {
        length * self.scale
    }

    /// Converts a length from local units to model units.
    #[inline]
    pub fn model_length(&self, length: f64) -> f64 {
        length * self.unit
    }

    /// Converts a squared length or an area from local units to model units.
    #[inline]
    pub fn model_squared(&self, squared: f64) -> f64 {
        squared * self.unit * self.unit
    }
}

/// Half the sides of a box; none too long for `f64`.
fn half_sides(bounds: &Bounds) -> DVec3 {
    DVec3::from(bounds.max) * 0.5 - DVec3::from(bounds.min) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(min: f64, max: f64) -> Bounds {
        Bounds { min: [min; 3], max: [max; 3] }
    }

    #[test]
    fn every_finite_box_comes_to_a_size_near_one() {
        for (min, max) in
            [(-1.0, 1.0), (1e6, 1e6 + 1.0), (-1e308, 1e308), (0.0, 1e-200), (1e-5, 3e7)]
        {
            let corner = Frame::of(&cube(min, max)).local([max; 3]).x;
            assert!((0.99..2.3).contains(&corner), "{min} {max}: {corner}");
        }
    }

    #[test]
    fn the_unit_of_the_diagonal_suits_every_size() {
        for size in [1e-320, 1e-307, 1e-200, 1e-162, 1.0, 1e154, 1e200, 1e307] {
            let frame = Frame::of_diagonal(&cube(-size, size));
            let local = frame.local([size; 3]).as_vec3();
            assert!(local.x > 0.0 && local.x.is_finite(), "{size}: {local}");
            let back = frame.model(local)[0];
            assert!((back / size - 1.0).abs() < 1e-3, "{size}: {back}");
        }
        let frame = Frame::of_diagonal(&cube(0.0, 3.0));
        assert_eq!((frame.unit(), frame.scale()), (8.0, 0.125));
        assert_eq!((frame.local_length(2.0), frame.model_length(0.5)), (0.25, 4.0));
    }

    #[test]
    fn a_point_comes_back() {
        for frame in [Frame::of, Frame::of_diagonal] {
            let frame = frame(&Bounds { min: [1e6, 0.0, 0.0], max: [1e6 + 3.0, 1.0, 1.0] });
            let point = [1e6 + 2.125, 0.5, 0.25];
            assert_eq!(frame.model(frame.local(point)), point);
        }
    }

    #[test]
    fn a_box_without_extent_keeps_the_model_s_unit() {
        for frame in [Frame::of, Frame::of_diagonal] {
            assert_eq!(frame(&cube(7.0, 7.0)).local([9.0; 3]).x, 2.0);
            assert_eq!(frame(&Bounds::EMPTY), Frame::new([0.0; 3], 0));
        }
    }

    #[test]
    fn a_unit_that_is_no_power_of_two_is_refused() {
        for unit in [0.0, -2.0, 3.0, 1e-320, 2f64.powi(1023), f64::INFINITY, f64::NAN] {
            assert_eq!(Frame::from_unit([0.0; 3], unit), None, "{unit}");
        }
        assert_eq!(Frame::from_unit([f64::NAN; 3], 1.0), None);
        for exponent in [-1022, -3, 0, 1022] {
            let frame = Frame::from_unit([1.0; 3], 2f64.powi(exponent));
            assert_eq!(frame, Some(Frame::new([1.0; 3], exponent)), "{exponent}");
        }
        assert_eq!(Frame::new([0.0; 3], i32::MAX), Frame::new([0.0; 3], 1022));
    }
}
