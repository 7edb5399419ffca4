//! Linear prediction of values from the steps between known ones.

use glam::DVec3;

use super::fixed_order::{dot, length};

/// Weight of a slope of zero, against which all others are weighed.
const RIDGE: f64 = 0.02;

/// Slopes of values over places, fitted to known steps by least squares: one by all steps, and one
/// by those around a wedge alone.
#[derive(Default)]
pub(super) struct Slopes {
    wedges: Vec<u32>,
    places: Vec<DVec3>,
    steps: Vec<Step>,
    /// Normal matrices of the least squares, and later their inverses.
    all: Symmetric,
    around: Symmetric,
}

/// A step between two known wedges.
struct Step {
    direction: DVec3,
    /// One over the length.
    scale: f64,
    /// Weight by which the slope of all steps is fitted.
    weight: f64,
    is_around: bool,
    /// Places among the known wedges that the step leads to and from.
    ends: [usize; 2],
}

impl Slopes {
    /// Forgets all steps.
    pub(super) fn clear(&mut self) {
        self.wedges.clear();
        self.places.clear();
        self.steps.clear();
        self.all = Symmetric::diagonal(RIDGE);
        self.around = self.all;
    }

    /// Adds a known wedge, and returns its place among these.
    pub(super) fn add_wedge(&mut self, wedge: u32, place: DVec3) -> usize {
        self.wedges.push(wedge);
        self.places.push(place);
        self.wedges.len() - 1
    }

    /// Adds a step between known wedges, unless they are at one place.
    pub(super) fn add_step(&mut self, ends: [usize; 2], weight: f64) {
        self.add(ends, weight, false);
    }

    /// Adds a step between wedges around. By these alone all weigh 1.
    pub(super) fn add_step_around(&mut self, ends: [usize; 2], weight: f64) {
        self.add(ends, weight, true);
    }

    fn add(&mut self, ends: [usize; 2], weight: f64, is_around: bool) {
        let [to, from] = ends.map(|end| self.places[end]);
        let way = to - from;
        let scale = 1.0 / length(way);
        if !scale.is_finite() {
            return;
        }
        let direction = scale * way;
        self.all.add_square(direction, weight);
        if is_around {
            self.around.add_square(direction, 1.0);
        }
        self.steps.push(Step { direction, scale, weight, is_around, ends });
    }

    /// Fits the slopes to the steps added so far.
    pub(super) fn fit(&mut self) {
        self.all = self.all.inverse();
        self.around = self.around.inverse();
    }

    /// Returns the known wedges.
    pub(super) fn wedges(&self) -> &[u32] {
        &self.wedges
    }

    /// Computes by what share of the value of each known wedge values change along some ways, by all
    /// steps.
    pub(super) fn shares<const N: usize>(&self, ways: [DVec3; N], shares: &mut Vec<[f64; N]>) {
        let along = ways.map(|way| self.all.times(way));
        shares.clear();
        shares.resize(self.wedges.len(), [0.0; N]);
        for step in &self.steps {
            let parts = along.map(|along| step.weight * step.scale * dot(step.direction, along));
            let [to, from] = step.ends;
            (0..N).for_each(|k| shares[to][k] += parts[k]);
            (0..N).for_each(|k| shares[from][k] -= parts[k]);
        }
    }

    /// Computes by what share of the value of each known wedge values change along a way, by the steps
    /// around alone.
    pub(super) fn shares_around(&self, way: DVec3, shares: &mut Vec<[f64; 1]>) {
        let along = self.around.times(way);
        shares.clear();
        shares.resize(self.wedges.len(), [0.0]);
        for step in self.steps.iter().filter(|step| step.is_around) {
            let part = step.scale * dot(step.direction, along);
            let [to, from] = step.ends;
            shares[to][0] += part;
            shares[from][0] -= part;
        }
    }
}

/// A symmetric matrix.
///
/// The values in a file depend on the last bit of these results, so the order of operations is part
/// of the format.
#[derive(Clone, Copy, Debug, Default)]
struct Symmetric {
    xx: f64,
    xy: f64,
    xz: f64,
    yy: f64,
    yz: f64,
    zz: f64,
}

impl Symmetric {
    fn diagonal(x: f64) -> Self {
        Self { xx: x, yy: x, zz: x, ..Self::default() }
    }

    /// Adds a vector times its transpose.
    fn add_square(&mut self, v: DVec3, weight: f64) {
        let DVec3 { x, y, z } = weight * v;
        self.xx += x * v.x;
        self.xy += x * v.y;
        self.xz += x * v.z;
        self.yy += y * v.y;
        self.yz += y * v.z;
        self.zz += z * v.z;
    }

    /// Returns the inverse: the cofactors, each times one over the determinant.
    fn inverse(&self) -> Self {
        let Self { xx, xy, xz, yy, yz, zz } = *self;
        let [a, b, c] = [yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy];
        let scale = 1.0 / (xx * a + xy * b + xz * c);
        Self {
            xx: scale * a,
            xy: scale * b,
            xz: scale * c,
            yy: scale * (xx * zz - xz * xz),
            yz: scale * (xy * xz - xx * yz),
            zz: scale * (xx * yy - xy * xy),
        }
    }

    fn times(&self, v: DVec3) -> DVec3 {
        let Self { xx, xy, xz, yy, yz, zz } = *self;
        DVec3::new(
            xx * v.x + xy * v.y + xz * v.z,
            xy * v.x + yy * v.y + yz * v.z,
            xz * v.x + yz * v.y + zz * v.z,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_function_is_continued() {
        let at = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.1), DVec3::new(0.3, 1.0, 0.0)];
        let value = |p: DVec3| 3.0 * p.x - 5.0 * p.y;
        let (mut slopes, mut shares) = (Slopes::default(), Vec::new());
        slopes.clear();
        (0..)
            .zip(at)
            .for_each(|(wedge, place)| assert_eq!(slopes.add_wedge(wedge, place), wedge as usize));
        for ends in [[1, 0], [2, 0], [0, 0]] {
            slopes.add_step_around(ends, 1.0);
        }
        slopes.fit();
        let way = DVec3::new(1.0, 1.0, 0.0);
        let change = |shares: &[[f64; 1]]| {
            shares.iter().zip(at).map(|(share, at)| share[0] * value(at)).sum::<f64>()
        };
        slopes.shares([way], &mut shares);
        assert!((change(&shares) - value(way)).abs() < 0.3, "{shares:?}");
        let all = shares.clone();
        slopes.shares_around(way, &mut shares);
        assert_eq!(shares, all);
        slopes.clear();
        slopes.fit();
        slopes.shares([way], &mut shares);
        assert!(shares.is_empty());
    }

    #[test]
    fn the_inverse_undoes_the_matrix() {
        let mut matrix = Symmetric::diagonal(RIDGE);
        for (way, weight) in [(DVec3::new(1.0, -2.0, 0.5), 8.0), (DVec3::new(0.0, 3.0, 1.0), 0.25)]
        {
            matrix.add_square(way.normalize(), weight);
        }
        for v in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(-3.0, 5.0, 0.1)] {
            assert!(matrix.inverse().times(matrix.times(v)).distance(v) < 1e-12);
        }
    }
}
