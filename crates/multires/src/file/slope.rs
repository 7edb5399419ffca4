//! Linear prediction of values from the steps between known ones.

use glam::{DMat3, DVec3};

/// Weight of a slope of zero, against which all others are weighed.
const RIDGE: f64 = 0.02;

/// Slope of values over places, fitted to known steps by least squares.
#[derive(Default)]
pub(super) struct Slope {
    steps: Vec<Step>,
    /// Normal matrix of the least squares, by columns.
    normal: [DVec3; 3],
}

impl Slope {
    /// Adds a known step between two wedges, given the way between them.
    pub(super) fn add(&mut self, way: DVec3, ends: [u32; 2], weight: f64) {
        let length = way.length_squared().sqrt();
        if length > 0.0 {
            let direction = way / length;
            self.steps.push(Step { direction, length, weight, ends });
            for k in 0..3 {
                self.normal[k] += weight * direction[k] * direction;
            }
        }
    }

    /// Returns by what part of each known step values change along a way.
    pub(super) fn parts(&self, way: DVec3) -> Vec<(f64, [u32; 2])> {
        let ridge = |k: usize| self.normal[k] + RIDGE * DVec3::AXES[k];
        let matrix = DMat3::from_cols(ridge(0), ridge(1), ridge(2));
        let along = matrix.inverse() * way;
        let part = |step: &Step| step.weight * step.direction.dot(along) / step.length;
        self.steps.iter().map(|step| (part(step), step.ends)).collect()
    }
}

struct Step {
    direction: DVec3,
    length: f64,
    weight: f64,
    /// The wedges that the step leads to and from.
    ends: [u32; 2],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_function_is_continued() {
        let at = [DVec3::ZERO, DVec3::new(2.0, 0.0, 0.1), DVec3::new(0.3, 1.0, 0.0)];
        let value = |p: DVec3| 3.0 * p.x - 5.0 * p.y;
        let mut slope = Slope::default();
        for ends in [[1, 0], [2, 0], [0, 0]] {
            let [to, from] = ends.map(|wedge| at[wedge as usize]);
            slope.add(to - from, ends, 1.0);
        }
        let way = DVec3::new(1.0, 1.0, 0.0);
        let step = |[to, from]: [u32; 2]| value(at[to as usize]) - value(at[from as usize]);
        let found: f64 = slope.parts(way).into_iter().map(|(part, ends)| part * step(ends)).sum();
        assert!((found - value(way)).abs() < 0.3, "{found}");
        assert!(Slope::default().parts(way).is_empty());
    }
}
