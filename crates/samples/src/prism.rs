//! A prism with a hundred sides, and two plates: flats that are not at right angles, or open.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};
use meshlod_mesh::{Mesh, VertexId};

use crate::grid::{Size, open, split};

/// Number of sides of the prism.
const SIDES: usize = 100;

/// Distance between the plates, whose side is 2.
const APART: f64 = 1.8;

/// Builds a prism with 100 sides, its bases divided into rings.
///
/// Closed. The face count is within 400 of `faces` from 1,000 faces on.
pub fn prism(faces: usize) -> Mesh {
    // Rows of the sides, and rings of each base.
    let bands = (faces.saturating_sub(2 * SIDES) / (2 * SIDES)).max(3);
    let rings = bands / 4;
    let rows = (bands - 2 * rings).max(1);
    let outline = |k: usize, radius: f64, height: f64| {
        let (sine, cosine) = (TAU * k as f64 / SIDES as f64).sin_cos();
        let at = radius * DVec2::new(cosine, sine);
        DVec3::new(at.x, height, -at.y)
    };
    // From the middle of the lower base outwards, up, and to the middle of the upper base.
    let inner = |ring: usize| (ring + 1) as f64 / (rings + 1) as f64;
    let lower = (0..rings).map(|ring| (inner(ring), -0.5));
    let side = (0..=rows).map(|row| (1.0, row as f64 / rows as f64 - 0.5));
    let upper = (0..rings).rev().map(|ring| (inner(ring), 0.5));
    let loops: Vec<(f64, f64)> = lower.chain(side).chain(upper).collect();
    let mut mesh = Mesh::default();
    for &(radius, height) in &loops {
        mesh.positions.extend((0..SIDES).map(|k| outline(k, radius, height).to_array()));
    }
    mesh.positions.extend([[0.0, -0.5, 0.0], [0.0, 0.5, 0.0]]);
    let [bottom, top] = [0, 1].map(|i| VertexId::new(SIDES * loops.len() + i));
    let at = |band: usize, k: usize| VertexId::new(SIDES * band + k % SIDES);
    let last = loops.len() - 1;
    for k in 0..SIDES {
        mesh.faces.push([bottom, at(0, k + 1), at(0, k)]);
        for band in 0..last {
            let quad = [at(band, k), at(band, k + 1), at(band + 1, k + 1), at(band + 1, k)];
            mesh.faces.extend(split(quad));
        }
        mesh.faces.push([top, at(last, k), at(last, k + 1)]);
    }
    mesh
}

/// Builds two square plates without thickness that face each other.
///
/// Open. The face count is four times a square number.
pub fn plates(faces: usize) -> Mesh {
    let squares = ((faces as f64 / 4.0).sqrt().round() as usize).max(1);
    let size = Size { columns: squares, rows: squares };
    let plate = |height: f64| {
        let along = move |k: usize| 2.0 * k as f64 / squares as f64 - 1.0;
        open(size, move |column, row| DVec3::new(along(column), height, -along(row)))
    };
    let (mut both, upper) = (plate(-APART / 2.0), plate(APART / 2.0));
    let first = both.positions.len();
    both.positions.extend(upper.positions);
    let moved = |face: [VertexId; 3]| face.map(|v| VertexId::new(first + v.index()));
    both.faces.extend(upper.faces.into_iter().map(moved));
    both
}
