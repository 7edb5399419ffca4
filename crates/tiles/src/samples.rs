//! Points of the model that go with tiles, by which their distance from it is measured.
//!
//! A leaf takes points evenly by area; a coarser tile keeps as many of those of its parts, evenly by
//! the area that each stands for. So no tile needs the model again.

use glam::DVec3;
use meshlod_mesh::Mesh;
use serde::{Deserialize, Serialize};

/// Number of points of a leaf, and of any other tile.
const OF_LEAF: usize = 256;
const OF_TILE: usize = 1024;

/// Fractional parts of the multiples of these are spread evenly over a square [Rob18].
const SPREAD: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053_3];

/// Points of the model in a cell, in steps of the lattice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// The points.
    pub points: Vec<[f32; 3]>,
    /// Area that they stand for together, in squared steps.
    pub area: f32,
}

/// Distance of points of the model from a tile, in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MeasuredError {
    /// Mean distance.
    pub mean: f64,
    /// Greatest distance.
    pub max: f64,
    /// Number of points.
    pub samples: usize,
}

impl Samples {
    /// Takes points of a leaf.
    pub fn of_leaf(mesh: &Mesh) -> Self {
        let corners =
            |face: usize| mesh.faces[face].map(|v| DVec3::from(mesh.positions[v.index()]));
        let areas = (0..mesh.faces.len()).map(|face| {
            let [a, b, c] = corners(face);
            0.5 * (b - a).cross(c - a).length()
        });
        let areas: Vec<f64> = areas.collect();
        let mut points = Vec::new();
        for (i, face) in evenly(&areas, OF_LEAF).into_iter().enumerate() {
            let [a, b, c] = corners(face);
            let [u, v] = SPREAD.map(|step| (step * i as f64).fract());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            points.push((a + u * (b - a) + v * (c - a)).as_vec3().to_array());
        }
        Self { points, area: areas.iter().sum::<f64>() as f32 }
    }

    /// Chooses among the points of the parts of a tile.
    pub fn of_parts(parts: &[Self]) -> Self {
        let all = parts.iter().flat_map(|part| {
            let own = f64::from(part.area) / part.points.len().max(1) as f64;
            part.points.iter().map(move |&point| (point, own))
        });
        let (points, areas): (Vec<_>, Vec<_>) = all.unzip();
        let area = parts.iter().map(|part| part.area).sum();
        if points.len() <= OF_TILE {
            return Self { points, area };
        }
        Self { points: evenly(&areas, OF_TILE).into_iter().map(|i| points[i]).collect(), area }
    }

    /// Returns the points as a mesh without faces.
    pub fn mesh(&self) -> Mesh {
        let positions = self.points.iter().map(|point| point.map(f64::from)).collect();
        Mesh { positions, ..Mesh::default() }
    }
}

impl MeasuredError {
    /// Sums up distances, in steps of the lattice; `None` if there are none.
    pub fn of(distances: &[f64], step: f64) -> Option<Self> {
        let samples = distances.len();
        let max = distances.iter().copied().reduce(f64::max)?;
        let mean = distances.iter().sum::<f64>() / samples as f64;
        Some(Self { mean: mean * step, max: max * step, samples })
    }
}

/// Returns a number of places where the sums of weights pass equal steps; fewer if there is no weight.
fn evenly(weights: &[f64], count: usize) -> Vec<usize> {
    let step = weights.iter().sum::<f64>() / count as f64;
    let mut chosen = Vec::with_capacity(count);
    let mut sum = 0.0;
    for (i, weight) in weights.iter().enumerate() {
        sum += weight;
        while chosen.len() < count && sum > (chosen.len() as f64 + 0.5) * step {
            chosen.push(i);
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_as_dense_everywhere() {
        let mesh = meshlod_fixtures::grid(8);
        let leaf = Samples::of_leaf(&mesh);
        assert_eq!(leaf.points.len(), OF_LEAF);
        let bounds = mesh.bounds();
        let middle = 0.5 * (bounds.min[0] + bounds.max[0]);
        let left = leaf.points.iter().filter(|point| f64::from(point[0]) < middle).count();
        assert!((118..=138).contains(&left), "{left}");

        let small = Samples { points: vec![[1.0; 3]; OF_LEAF], area: 0.25 * leaf.area };
        let parts = [vec![leaf; 7], vec![small]].concat();
        let both = Samples::of_parts(&parts);
        assert_eq!(both.points.len(), OF_TILE);
        let of_small = both.points.iter().filter(|point| **point == [1.0; 3]).count();
        assert!((34..=36).contains(&of_small), "{of_small}");
    }

    #[test]
    fn what_has_no_area_has_no_points() {
        assert_eq!(Samples::of_leaf(&Mesh::default()), Samples::default());
        assert_eq!(MeasuredError::of(&[], 1.0), None);
        let found = MeasuredError::of(&[1.0, 3.0], 0.5);
        assert_eq!(found, Some(MeasuredError { mean: 1.0, max: 1.5, samples: 2 }));
    }
}
