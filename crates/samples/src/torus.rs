//! Sample meshes of tori, smooth and faceted.

use std::f64::consts::TAU;

use glam::DVec3;
use meshlod_mesh::Mesh;

use crate::grid::{self, Size};

/// Distance from the axis to the center line of the tube.
const RING: f64 = 0.7;
/// Radius of the tube.
const TUBE: f64 = 0.3;

/// Builds a smooth torus around the y axis, from nearly square quads split into two faces each.
///
/// Faces: within half a row of quads around the tube of `faces`, a few percent from 1,000 on; at
/// least 18.
pub fn torus(faces: usize) -> Mesh {
    let size = Size::for_faces(faces, RING / TUBE);
    grid::wrapped(size, |column, row| {
        point(column as f64 / size.columns as f64, row as f64 / size.rows as f64)
    })
}

/// Number of flat facets around the axis and around the tube.
const FACETS: Size = Size { columns: 12, rows: 6 };

/// Builds a torus with creases: 12 × 6 flat trapezoids, each finely subdivided.
///
/// A good simplifier removes all but 144 faces without error and keeps every crease sharp.
///
/// Faces: 144 times the product of two integers that differ little, within one part in the square
/// root of `faces / 144`; at least 144.
pub fn faceted_torus(faces: usize) -> Mesh {
    let parts = faces as f64 / (2 * FACETS.columns * FACETS.rows) as f64;
    let rows = parts.sqrt().round().max(1.0);
    let split = Size { columns: (parts / rows).round().max(1.0) as usize, rows: rows as usize };
    let size = Size { columns: FACETS.columns * split.columns, rows: FACETS.rows * split.rows };
    grid::wrapped(size, |column, row| {
        let (c, s) = (column / split.columns, fraction(column, split.columns));
        let (r, t) = (row / split.rows, fraction(row, split.rows));
        let corner = |c: usize, r: usize| {
            point(c as f64 / FACETS.columns as f64, r as f64 / FACETS.rows as f64)
        };
        let near = corner(c, r).lerp(corner(c, r + 1), t);
        let far = corner(c + 1, r).lerp(corner(c + 1, r + 1), t);
        near.lerp(far, s)
    })
}

/// Returns the relative position of `i` in its group of `of`, in [0, 1).
fn fraction(i: usize, of: usize) -> f64 {
    (i % of) as f64 / of as f64
}

/// Returns the point at `u` turns around the axis and `v` turns around the tube.
fn point(u: f64, v: f64) -> DVec3 {
    let (sin_u, cos_u) = (TAU * u).sin_cos();
    let (sin_v, cos_v) = (TAU * v).sin_cos();
    let radius = RING + TUBE * cos_v;
    DVec3::new(radius * sin_u, TUBE * sin_v, radius * cos_u)
}
