//! Heights of a terrain, and curves that stay above it.

use std::f32::consts::TAU;

use glam::Vec3;
use meshlod::mesh::Mesh;

/// Cells along a side of the map.
const SIDE: usize = 128;

/// Heights along a circle.
const STEPS: usize = 256;

/// Upper bounds of a terrain's height, on a grid over its extent along x and z.
pub(super) struct Ground {
    origin: [f32; 2],
    cell: [f32; 2],
    /// Greatest height in each cell; rows along x.
    highest: Vec<f32>,
}

impl Ground {
    /// Finds the heights of a valid mesh; `None` if it has no extent along x or z.
    pub(super) fn new(mesh: &Mesh) -> Option<Self> {
        let bounds = mesh.bounds();
        let [[x0, z0], [x1, z1]] = [bounds.min, bounds.max].map(|p| [p[0] as f32, p[2] as f32]);
        let cell = [(x1 - x0) / SIDE as f32, (z1 - z0) / SIDE as f32];
        if bounds.is_empty() || !cell.iter().all(|side| side.is_normal()) {
            return None;
        }
        let mut ground =
            Self { origin: [x0, z0], cell, highest: vec![bounds.min[1] as f32; SIDE * SIDE] };
        for &face in &mesh.faces {
            let corners = mesh.triangle(face).map(|p| p.as_vec3());
            let [a, b, c] = corners;
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            let cells = ground.cells([low.x, low.z], [high.x, high.z]);
            cells.for_each(|i| ground.highest[i] = ground.highest[i].max(high.y));
        }
        Some(ground)
    }

    /// Returns the greatest height within a square around a point, `reach` in all four directions.
    pub(super) fn highest(&self, at: Vec3, reach: f32) -> f32 {
        let cells = self.cells([at.x - reach, at.z - reach], [at.x + reach, at.z + reach]);
        cells.map(|i| self.highest[i]).fold(f32::MIN, f32::max)
    }

    /// Returns the cells that a rectangle overlaps; at least one.
    fn cells(&self, low: [f32; 2], high: [f32; 2]) -> impl Iterator<Item = usize> + use<> {
        let index = |value: f32, axis: usize| {
            (((value - self.origin[axis]) / self.cell[axis]) as usize).min(SIDE - 1)
        };
        let [rows, columns] = [1, 0].map(|axis| index(low[axis], axis)..=index(high[axis], axis));
        rows.flat_map(move |row| columns.clone().map(move |column| row * SIDE + column))
    }
}

/// Heights of a closed curve round the y axis, smooth in the angle.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CircleHeights {
    values: Vec<f32>,
}

impl CircleHeights {
    /// Returns a smooth curve that never falls below `least`, the lowest height at every angle.
    ///
    /// `window` is the angle over which heights are averaged.
    pub(super) fn above(least: impl Fn(f32) -> f32, window: f32) -> Self {
        let angle = |i: usize| i as f32 / STEPS as f32 * TAU;
        let values: Vec<f32> = (0..STEPS).map(|i| least(angle(i))).collect();
        let reach = ((window / TAU * STEPS as f32) as usize).clamp(1, STEPS / 8);
        // Every mean is over values at least as high as the middle one.
        let widened = around(&values, 2 * reach + 2, |near| near.fold(f32::MIN, f32::max));
        let mean = |near: &mut dyn Iterator<Item = f32>| near.sum::<f32>() / (2 * reach + 1) as f32;
        let once = around(&widened, reach, mean);
        Self { values: around(&once, reach, mean) }
    }

    /// Returns the height at an angle.
    pub(super) fn at(&self, angle: f32) -> f32 {
        let place = (angle / TAU).rem_euclid(1.0) * STEPS as f32;
        let (whole, t) = (place.floor() as usize, place.fract());
        let [a, b, c, d] = [STEPS - 1, 0, 1, 2].map(|i| self.values[(whole + i) % STEPS]);
        // A cubic B-spline: it has no kinks, and it stays among the values around.
        let s = 1.0 - t;
        let outer = a * s * s * s + d * t * t * t;
        let near = b * (4.0 - 6.0 * t * t + 3.0 * t * t * t);
        (outer + near + c * (4.0 - 6.0 * s * s + 3.0 * s * s * s)) / 6.0
    }
}

/// Applies `what` to the values within `reach` of each value of a ring.
fn around(
    values: &[f32],
    reach: usize,
    what: impl Fn(&mut dyn Iterator<Item = f32>) -> f32,
) -> Vec<f32> {
    let count = values.len();
    let near = |i: usize| (0..=2 * reach).map(move |k| values[(i + count + k - reach) % count]);
    (0..count).map(|i| what(&mut near(i))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_stays_above_the_peaks_of_a_terrain() {
        let terrain = meshlod::samples::terrain(5_000);
        let ground = Ground::new(&terrain).unwrap();
        let place = |angle: f32| Vec3::new(0.7 * angle.cos(), 0.0, -0.7 * angle.sin());
        let curve = CircleHeights::above(|angle| ground.highest(place(angle), 0.03), 0.3);
        for &[x, y, z] in &terrain.positions {
            let angle = (-z).atan2(x) as f32;
            if (x.hypot(z) - 0.7).abs() < 0.02 {
                assert!(curve.at(angle) > y as f32, "{angle}");
            }
        }
    }
}
