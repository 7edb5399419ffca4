//! Lattice of whole numbers that all vertices are moved to before anything else.
//!
//! Vertices have odd coordinates, planes between cells even ones. So no vertex of the input is ever
//! on a plane, and no face is in one: what is on a plane has been put there by a cut.

use meshlod_mesh::Bounds;
use serde::{Deserialize, Serialize};

/// Number of bits of a coordinate: those of the position and one that is 1 for vertices.
pub const BITS: u32 = 22;

/// Largest coordinate of a point, on the far side of the whole.
pub const END: i32 = 1 << BITS;

/// Point of the lattice. Vertices of the input have odd coordinates; a point on a plane between
/// cells has an even one on that axis.
pub type Point = [i32; 3];

/// Lattice over the bounding box of a model, the same for everything that is made of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TileLattice {
    /// Place of the point 0, 0, 0, in model units: a multiple of the step on each axis, if the model
    /// is not too far away from the origin for that.
    pub origin: [f64; 3],
    /// Length of a step, in model units: a power of two. Vertices are on every second one.
    pub step: f64,
}

impl TileLattice {
    /// Returns the lattice over a box; `None` if that has no extent, or one beyond the numbers.
    pub fn over(bounds: &Bounds) -> Option<Self> {
        let sides = [0, 1, 2].map(|axis| bounds.max[axis] - bounds.min[axis]);
        let longest = sides.into_iter().fold(0.0, f64::max);
        if !(longest.is_normal() && longest < 1e300) {
            return None;
        }
        // Room for a margin of two steps on both sides.
        let step = (longest / f64::from(END - 8)).log2().ceil().exp2();
        let origin = bounds.min.map(|least| ((least / step).floor() - 2.0) * step);
        (step.is_normal() && origin.iter().all(|x| x.is_finite())).then_some(Self { origin, step })
    }

    /// Returns the odd point closest to a place of the box.
    pub fn point(&self, place: [f64; 3]) -> Point {
        [0, 1, 2].map(|axis| {
            let steps = (place[axis] - self.origin[axis]) / self.step;
            2 * ((steps / 2.0).floor() as i32).clamp(0, END / 2 - 1) + 1
        })
    }

    /// Returns the place of a point, which need not be whole.
    pub fn place(&self, point: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.origin[axis] + point[axis] * self.step)
    }

    /// Returns the greatest distance by which a vertex is moved to the lattice, in model units.
    pub fn rounding(&self) -> f64 {
        // Half of two steps on each axis, and what the subtraction of the origin may round.
        let far = self.origin.iter().fold(f64::from(END) * self.step, |far, x| far.max(x.abs()));
        3f64.sqrt() * (self.step + 4.0 * f64::EPSILON * far)
    }
}

/// Returns the odd number closest to `n / d`, the greater one of two.
pub(crate) fn nearest_odd(n: i64, d: i64) -> i32 {
    (2 * n.div_euclid(2 * d) + 1) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_are_odd_and_close() {
        let bounds = Bounds { min: [-1.0, 500_000.25, 0.0], max: [2.0, 500_001.0, 0.0] };
        let lattice = TileLattice::over(&bounds).unwrap();
        assert_eq!(lattice.step.log2().fract(), 0.0);
        for place in [bounds.min, bounds.max, bounds.center(), [0.1, 500_000.7, 0.0]] {
            let point = lattice.point(place);
            assert!(point.iter().all(|x| x % 2 == 1 && (1..END).contains(x)), "{point:?}");
            let back = lattice.place(point.map(f64::from));
            let off: f64 = (0..3).map(|axis| (back[axis] - place[axis]).powi(2)).sum();
            assert!(off.sqrt() <= lattice.rounding());
        }
    }

    #[test]
    fn what_has_no_extent_has_no_lattice() {
        let point = Bounds { min: [1.0; 3], max: [1.0; 3] };
        let huge = Bounds { min: [-1e308; 3], max: [1e308; 3] };
        assert!(TileLattice::over(&point).is_none() && TileLattice::over(&huge).is_none());
        assert!(TileLattice::over(&Bounds::EMPTY).is_none());
    }

    #[test]
    fn fractions_round_to_the_nearest_odd_number() {
        let all = [(0, 1), (5, 1), (9, 2), (-3, 1), (-4, 3), (4, 1), (401, 100), (399, 100)];
        assert_eq!(all.map(|(n, d)| nearest_odd(n, d)), [1, 5, 5, -3, -1, 5, 5, 3]);
    }
}
