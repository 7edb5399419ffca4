//! How the surface leans at a node, guessed from the families above: the children of a node lie in the
//! surface, and so did those of the nodes above. What is told across it is small.

use glam::{DVec3, Vec3};

/// A plane through the node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NormalPredictor {
    normal: DVec3,
    /// The axis that it is closest to.
    axis: usize,
}

/// Below this part of what a right angle would give, two families say little of a plane.
const MIN_SINE: f64 = 0.3;

impl NormalPredictor {
    /// By the families above, the closest first.
    pub(super) fn of(above: [Option<[Vec3; 2]>; 3]) -> Self {
        let [a, b, c] =
            above.map(|family| family.map_or(DVec3::ZERO, |[a, b]| b.as_dvec3() - a.as_dvec3()));
        let (first, second) = (a.cross(b), a.cross(c));
        // What both say, in proportion to the lengths of b and c.
        let is_clear = first.length() >= MIN_SINE * a.length() * b.length();
        let is_better = second.length() * b.length() > first.length() * c.length();
        let normal = if is_clear || !is_better { first } else { second };
        let normal = if normal == DVec3::ZERO { DVec3::Z } else { normal };
        Self { normal, axis: normal.abs().max_position() }
    }

    /// Encodes a vector: two components, and the residual of the predicted third.
    pub(super) fn encode(&self, steps: [i32; 3]) -> [i32; 3] {
        let [i, j, k] = self.axes();
        [steps[i], steps[j], steps[k].wrapping_sub(self.in_plane_component(steps[i], steps[j]))]
    }

    /// What was folded.
    pub(super) fn decode(&self, [u, v, off]: [i32; 3]) -> [i32; 3] {
        let mut steps = [0; 3];
        let [i, j, k] = self.axes();
        (steps[i], steps[j]) = (u, v);
        steps[k] = off.wrapping_add(self.in_plane_component(u, v));
        steps
    }

    /// Whether the first of the steps that are told is below 0, or the next where that is none.
    pub(super) fn is_backwards(&self, apart: DVec3) -> bool {
        let [i, j, k] = self.axes();
        let steps = [apart[i], apart[j], apart[k]];
        steps.into_iter().find(|&step| step != 0.0).is_some_and(|step| step < 0.0)
    }

    fn axes(&self) -> [usize; 3] {
        [(self.axis + 1) % 3, (self.axis + 2) % 3, self.axis]
    }

    /// The third step that lies in the plane.
    fn in_plane_component(&self, u: i32, v: i32) -> i32 {
        let [i, j, k] = self.axes();
        let across = self.normal[i] * f64::from(u) + self.normal[j] * f64::from(v);
        (-across / self.normal[k]).round() as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn family(apart: [f32; 3]) -> Option<[Vec3; 2]> {
        Some([Vec3::ONE, Vec3::ONE + Vec3::from(apart)])
    }

    #[test]
    fn what_lies_in_the_plane_is_nothing_across_it() {
        let predictor =
            NormalPredictor::of([family([1.0, 0.0, 2.0]), family([0.0, 1.0, -1.0]), None]);
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
        let predictor = NormalPredictor::of([row, row, family([0.0, 0.0, 1.0])]);
        assert_eq!(predictor.axis, 1);
        assert_eq!(NormalPredictor::of([None; 3]).encode([1, 2, 3]), [1, 2, 3]);
    }
}
