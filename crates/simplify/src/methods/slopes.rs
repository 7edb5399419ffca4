//! Gradients of linear functions over a face.

use glam::DVec3;

/// Squared sine of a face's angles below which no gradient on it can be trusted: it would grow
/// without bound as the face narrows. Flight helmet, duck and fish are the same for 0 and for 1e-4
/// to 1 %.
const SLIVER: f64 = 1e-6;

/// Gradient of a linear function over a triangle, given its values at the corners.
pub(crate) struct Slopes {
    /// Gradient for a unit step of the value at each of the other two corners.
    to: [DVec3; 2],
    pub(crate) area: f64,
}

impl Slopes {
    /// Prepares the triangle from the origin to `a` and `b`; `None` for a sliver.
    pub(crate) fn of(a: DVec3, b: DVec3) -> Option<Self> {
        let normal = a.cross(b);
        let squared = normal.length_squared();
        let longest = a.length_squared().max(b.length_squared()).max(a.distance_squared(b));
        (squared > SLIVER * longest * longest).then(|| Self {
            to: [b.cross(normal) / squared, normal.cross(a) / squared],
            area: 0.5 * squared.sqrt(),
        })
    }

    #[inline]
    pub(crate) fn slope(&self, to_a: f64, to_b: f64) -> DVec3 {
        self.to[0] * to_a + self.to[1] * to_b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_is_that_of_the_linear_function() {
        let (a, b) = (DVec3::new(2.0, 0.0, 1.0), DVec3::new(-1.0, 3.0, 0.0));
        let linear = DVec3::new(0.5, -2.0, 4.0);
        let slope = Slopes::of(a, b).unwrap().slope(linear.dot(a), linear.dot(b));
        assert!((slope.dot(a) - linear.dot(a)).abs() < 1e-12);
        assert!((slope.dot(b) - linear.dot(b)).abs() < 1e-12);
        assert!(slope.dot(a.cross(b)).abs() < 1e-12, "it lies in the face");
    }

    #[test]
    fn a_sliver_has_none() {
        assert!(Slopes::of(DVec3::X, DVec3::new(0.5, 1e-4, 0.0)).is_none());
        assert!(Slopes::of(DVec3::X, DVec3::new(0.5, 1e-2, 0.0)).is_some());
        assert!(Slopes::of(DVec3::ZERO, DVec3::ZERO).is_none());
    }
}
