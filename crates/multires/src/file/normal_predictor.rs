//! Prediction of the surface normal at a node from the updates above it.
//!
//! The children of a node lie roughly in the surface, and so did those of its ancestors. A vector
//! between children therefore has a small component across the plane that these span.

use glam::{DVec3, Vec3};

use super::fixed_order::{cross, length};

/// Plane through a node, approximately tangent to the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NormalPredictor {
    normal: DVec3,
    /// Axis along which the normal is longest.
    axis: usize,
}

/// Minimum sine of the angle at which two vectors count as spanning a plane.
const MIN_SINE: f64 = 0.3;

impl NormalPredictor {
    /// Predicts the plane from the pairs of children above, the closest ancestor first.
    pub(super) fn from_ancestors(above: [Option<[Vec3; 2]>; 3]) -> Self {
        let [a, b, c] =
            above.map(|family| family.map_or(DVec3::ZERO, |[a, b]| b.as_dvec3() - a.as_dvec3()));
        let (first, second) = (cross(a, b), cross(a, c));
        // Both sines are scaled by the lengths of `b` and `c`, to compare them without a division.
        let is_clear = length(first) >= MIN_SINE * length(a) * length(b);
        let is_better = length(second) * length(b) > length(first) * length(c);
        let normal = if is_clear || !is_better { first } else { second };
        let normal = if normal == DVec3::ZERO { DVec3::Z } else { normal };
        Self { normal, axis: normal.abs().max_position() }
    }

    /// Encodes a vector as two of its components and the residual of the third.
    pub(super) fn encode(&self, steps: [i32; 3]) -> [i32; 3] {
        let [i, j, k] = self.axes();
        [steps[i], steps[j], steps[k].wrapping_sub(self.in_plane_component(steps[i], steps[j]))]
    }

    /// Decodes a vector that [`encode`](Self::encode) has encoded.
    pub(super) fn decode(&self, [u, v, residual]: [i32; 3]) -> [i32; 3] {
        let mut steps = [0; 3];
        let [i, j, k] = self.axes();
        (steps[i], steps[j]) = (u, v);
        steps[k] = residual.wrapping_add(self.in_plane_component(u, v));
        steps
    }

    /// Returns true if the first non-zero component, in coding order, is negative.
    pub(super) fn is_lead_negative(&self, difference: DVec3) -> bool {
        let [i, j, k] = self.axes();
        let steps = [difference[i], difference[j], difference[k]];
        steps.into_iter().find(|&step| step != 0.0).is_some_and(|step| step < 0.0)
    }

    fn axes(&self) -> [usize; 3] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3, self.axis]
    }

    /// Returns the third component of the vector in the plane whose first two are given.
    fn in_plane_component(&self, u: i32, v: i32) -> i32 {
        let [i, j, k] = self.axes();
        let across = self.normal[i] * f64::from(u) + self.normal[j] * f64::from(v);
        (-across / self.normal[k]).round() as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn family(difference: [f32; 3]) -> Option<[Vec3; 2]> {
        Some([Vec3::ONE, Vec3::ONE + Vec3::from(difference)])
    }

    #[test]
    fn what_lies_in_the_plane_is_nothing_across_it() {
        let predictor = NormalPredictor::from_ancestors([
            family([1.0, 0.0, 2.0]),
            family([0.0, 1.0, -1.0]),
            None,
        ]);
        assert_eq!(
            predictor.encode([3, 5, 1]),
            predictor.encode(predictor.decode(predictor.encode([3, 5, 1])))
        );
        let in_plane = [3, 5, 2 * 3 - 5];
        assert_eq!(predictor.encode(in_plane)[2], 0);
        for steps in [[1, 2, 3], [-9, 0, 4], [i32::MAX, i32::MIN, 17], [0; 3]] {
            assert_eq!(predictor.decode(predictor.encode(steps)), steps);
        }
    }

    #[test]
    fn families_in_a_row_ask_the_third() {
        let row = family([1.0, 0.0, 0.0]);
        let predictor = NormalPredictor::from_ancestors([row, row, family([0.0, 0.0, 1.0])]);
        assert_eq!(predictor.axis, 1);
        assert_eq!(NormalPredictor::from_ancestors([None; 3]).encode([1, 2, 3]), [1, 2, 3]);
    }
}
