//! Sample mesh of a gyroid (Schoen's minimal surface) inside a ball.

use std::f64::consts::TAU;

use glam::DVec3;
use meshlod_mesh::{Mesh, face_components};

use crate::tetrahedra::polygonize;

/// Periods of the gyroid across the lattice.
const PERIODS: f64 = 3.0;
/// Level whose inside is kept: below 0, so that tubes are thinner than tunnels.
pub(crate) const LEVEL: f64 = -0.3;
/// Radius of the ball, which stays clear of the border of the lattice.
const RADIUS: f64 = 0.97;
/// Width of the rounding along the edges that the ball cuts, in units of length.
const ROUNDING: f64 = 0.15;
/// Faces are near `SQUARE * cells² - LINE * cells`: fitted at 12 to 98 cells a side.
const SQUARE: f64 = 42.0;
const LINE: f64 = 52.0;

/// Builds one of the two labyrinths of the gyroid, a minimal surface, inside a ball: a closed
/// surface with dozens of tunnels.
///
/// Faces: within 5 % of `faces` from 20,000 on; at least about 5,000, below which the lattice would
/// be too coarse for the tunnels. The edges that the ball cuts are slightly rounded. The ball
/// grazes different tunnels at different sizes, so the genus varies, between 28 and 43. Cost:
/// O(faces^1.5).
/// # References
/// [Sch70], by the usual trigonometric level set.
pub fn gyroid(faces: usize) -> Mesh {
    let root = (LINE * LINE + 4.0 * SQUARE * faces as f64).sqrt();
    let cells = ((LINE + root) / (2.0 * SQUARE)).round().max(12.0) as usize;
    largest_piece(polygonize(cells, |p| both(labyrinth(p), p.length() - RADIUS)))
}

/// Signed field of the labyrinth: negative inside, with a slope of about 1 per unit of length.
fn labyrinth(p: DVec3) -> f64 {
    let scale = TAU * PERIODS / 2.0;
    let [(sx, cx), (sy, cy), (sz, cz)] = (p * scale).to_array().map(f64::sin_cos);
    (sx * cy + sy * cz + sz * cx - LEVEL) / (1.4 * scale)
}

/// Intersects two fields: negative where both are, with a rounded edge between them.
fn both(a: f64, b: f64) -> f64 {
    let near = (1.0 - (a - b).abs() / ROUNDING).max(0.0);
    a.max(b) + 0.25 * ROUNDING * near * near
}

/// Keeps only the component with the most faces, the first one in case of a tie.
fn largest_piece(mut mesh: Mesh) -> Mesh {
    let (of_face, count) = face_components(&mesh.faces, mesh.positions.len());
    let mut sizes = vec![0usize; count];
    for &component in &of_face {
        sizes[component as usize] += 1;
    }
    let largest = (0..count).rev().max_by_key(|&component| sizes[component]).unwrap_or(0) as u32;
    let mut component = of_face.iter();
    mesh.faces.retain(|_| component.next() == Some(&largest));
    mesh.compact();
    mesh
}
