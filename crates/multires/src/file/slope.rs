//! Linear prediction of values from the steps between known ones.

use glam::{DMat3, DVec3};

/// Weight of a slope of zero, against which all others are weighed.
const RIDGE: f64 = 0.02;

/// Slope of values over places, fitted to known steps by least squares.
#[derive(Default)]
pub(super) struct Slope {
    steps: Vec<Step>,
    /// Normal matrix of the least squares, by columns, and later its inverse.
    normal: DMat3,
}

/// A known step between two wedges.
pub(super) struct Step {
    direction: DVec3,
    /// Weight by length.
    weight: f64,
    /// The wedges that the step leads to and from.
    pub(super) ends: [u32; 2],
}

impl Slope {
    /// Forgets all steps.
    pub(super) fn clear(&mut self) {
        self.steps.clear();
        self.normal = DMat3::from_diagonal(DVec3::splat(RIDGE));
    }

    /// Adds a known step between two wedges, given the way between them.
    pub(super) fn add(&mut self, way: DVec3, ends: [u32; 2], weight: f64) {
        let length = way.length_squared().sqrt();
        if length > 0.0 {
            let direction = way / length;
            self.steps.push(Step { direction, weight: weight / length, ends });
            let scaled = weight * direction;
            self.normal.x_axis += direction.x * scaled;
            self.normal.y_axis += direction.y * scaled;
            self.normal.z_axis += direction.z * scaled;
        }
    }

    /// Fits the slope to the steps added so far.
    pub(super) fn fit(&mut self) {
        self.normal = self.normal.inverse();
    }

    /// Returns by what part of each known step values change along a way.
    pub(super) fn parts(&self, way: DVec3) -> impl Iterator<Item = (f64, [u32; 2])> {
        let along = self.normal * way;
        self.steps.iter().map(move |step| (step.weight * step.direction.dot(along), step.ends))
    }
}

impl Slope {
    /// Returns the wedges that each known step leads to and from.
    pub(super) fn ends(&self) -> impl Iterator<Item = [u32; 2]> {
        self.steps.iter().map(|step| step.ends)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_function_is_continued() {
        let at = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.1), DVec3::new(0.3, 1.0, 0.0)];
        let value = |p: DVec3| 3.0 * p.x - 5.0 * p.y;
        let mut slope = Slope::default();
        slope.clear();
        for ends in [[1, 0], [2, 0], [0, 0]] {
            let [to, from] = ends.map(|wedge| at[wedge as usize]);
            slope.add(to - from, ends, 1.0);
        }
        slope.fit();
        let way = DVec3::new(1.0, 1.0, 0.0);
        let step = |[to, from]: [u32; 2]| value(at[to as usize]) - value(at[from as usize]);
        let found: f64 = slope.parts(way).map(|(part, ends)| part * step(ends)).sum();
        assert!((found - value(way)).abs() < 0.3, "{found}");
        slope.clear();
        slope.fit();
        assert_eq!(slope.parts(way).count(), 0);
    }
}
