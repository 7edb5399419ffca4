//! A machined part: large flats, round holes, long thin faces and vertices with many faces.

use std::f64::consts::TAU;

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};

use crate::grid::split;

/// Sides of a hole where the number of faces leaves the choice.
const SIDES: usize = 64;
/// Radius of a hole relative to its tile's side.
const RADIUS: f64 = 0.35;
/// Half the thickness of the plate.
const HALF_THICKNESS: f64 = 0.1;

/// Builds a square plate with a grid of round holes, triangulated as CAD systems do: no vertex is
/// inside a flat, so its corners have about 70 faces each and most faces are long and thin.
///
/// Closed, of genus k² for k × k holes. The face count is within 4 % of `faces` from 1,000 faces
/// on.
pub fn plate(faces: usize) -> Mesh {
    let holes = ((faces as f64 / faces_per_tile(SIDES) as f64).sqrt().round() as usize).max(1);
    let wanted = (faces / (holes * holes)).saturating_sub(faces_per_tile(0)) / 4;
    let sides = ((wanted + 2) / 4 * 4).clamp(12, 4 * SIDES);
    with_holes(holes, sides)
}

/// Builds a plate of `holes` by `holes` holes, each of `sides` sides, a multiple of four.
pub(crate) fn with_holes(holes: usize, sides: usize) -> Mesh {
    let plate = Plate { holes, sides };
    Mesh { positions: plate.positions(), faces: plate.faces(), ..Mesh::default() }
}

/// Returns the number of faces of a tile, without the rim of the plate.
fn faces_per_tile(sides: usize) -> usize {
    4 * sides + 8
}

/// A plate of `holes` by `holes` square tiles, each with a hole of `sides` sides, a multiple of
/// four.
struct Plate {
    holes: usize,
    sides: usize,
}

/// Corners of a tile, in columns and rows, counter-clockwise seen from below.
const CORNERS: [[usize; 2]; 4] = [[1, 1], [0, 1], [0, 0], [1, 0]];

impl Plate {
    fn positions(&self) -> Vec<[f64; 3]> {
        let side = 2.0 / self.holes as f64;
        let at = |x: f64, z: f64| {
            [-HALF_THICKNESS, HALF_THICKNESS].map(|y| DVec3::new(x, y, z).to_array())
        };
        let mut positions = Vec::new();
        for (row, column) in pairs(self.holes + 1) {
            positions.extend(at(side * column as f64 - 1.0, side * row as f64 - 1.0));
        }
        for (row, column) in pairs(self.holes) {
            let [x, z] = [column, row].map(|k| side * (k as f64 + 0.5) - 1.0);
            for k in 0..self.sides {
                let (sin, cos) = (TAU * k as f64 / self.sides as f64).sin_cos();
                positions.extend(at(x + RADIUS * side * cos, z + RADIUS * side * sin));
            }
        }
        positions
    }

    fn faces(&self) -> Vec<[VertexId; 3]> {
        let mut faces = Vec::new();
        for (row, column) in pairs(self.holes) {
            self.push_tile(&mut faces, row, column);
        }
        let last = self.holes;
        for k in 0..last {
            let rims = [[k, 0, k + 1, 0], [k + 1, last, k, last]];
            let rims = rims.into_iter().chain([[0, k + 1, 0, k], [last, k, last, k + 1]]);
            for [from_column, from_row, to_column, to_row] in rims {
                let from = |top| self.corner(from_row, from_column, top);
                let to = |top| self.corner(to_row, to_column, top);
                faces.extend(split([from(1), to(1), to(0), from(0)]));
            }
        }
        faces
    }

    /// Appends the bottom, the top and the hole of a tile.
    fn push_tile(&self, faces: &mut Vec<[VertexId; 3]>, row: usize, column: usize) {
        let first = row * self.holes + column;
        let on_hole = |k: usize, top| self.on_hole(first, k % self.sides, top);
        let corner = |k: usize, top| {
            let [right, below] = CORNERS[k % 4];
            self.corner(row + below, column + right, top)
        };
        let mut push_flat = |[a, b, c]: [&dyn Fn(usize) -> VertexId; 3]| {
            faces.push([a(0), b(0), c(0)]);
            faces.push([a(1), c(1), b(1)]);
        };
        let quarter = self.sides / 4;
        for k in 0..self.sides {
            // A corner sees the quarter of the hole that faces it.
            let [from, to] = [k, k + 1].map(|k| move |top| on_hole(k, top));
            push_flat([&|top| corner(k / quarter, top), &to, &from]);
        }
        for k in 0..4 {
            let [from, to] = [k, k + 1].map(|k| move |top| corner(k, top));
            push_flat([&from, &to, &|top| on_hole((k + 1) * quarter, top)]);
        }
        for k in 0..self.sides {
            faces.extend(split([
                on_hole(k, 0),
                on_hole(k + 1, 0),
                on_hole(k + 1, 1),
                on_hole(k, 1),
            ]));
        }
    }

    /// Returns a corner of tiles, at the bottom (0) or top (1).
    fn corner(&self, row: usize, column: usize, top: usize) -> VertexId {
        VertexId::new(2 * (row * (self.holes + 1) + column) + top)
    }

    /// Returns vertex `k` of a tile's hole, at the bottom (0) or top (1).
    fn on_hole(&self, tile: usize, k: usize, top: usize) -> VertexId {
        let corners = (self.holes + 1) * (self.holes + 1);
        VertexId::new(2 * (corners + tile * self.sides + k) + top)
    }
}

/// Returns all pairs of numbers below `count`, row by row.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |row| (0..count).map(move |column| (row, column)))
}
