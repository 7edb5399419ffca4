//! Meshes of regular grids of quads, each split into two faces.

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};

/// Number of quads in each direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub columns: usize,
    pub rows: usize,
}

impl Size {
    /// Returns the size with about `faces / 2` quads and `aspect` times as many columns as rows, at
    /// least 3 of each.
    ///
    /// `2 * columns * rows` is within `rows` of `faces` from 18 faces on.
    pub fn for_faces(faces: usize, aspect: f64) -> Self {
        let quads = faces as f64 / 2.0;
        let rows = (quads / aspect).sqrt().round().max(3.0);
        let columns = (quads / rows).round().max(3.0);
        Self { columns: columns as usize, rows: rows as usize }
    }
}

/// Builds a grid closed in both directions, like a torus, from the vertices `place(column, row)`.
///
/// Faces point along (direction of columns) × (direction of rows).
pub(crate) fn wrapped(size: Size, place: impl Fn(usize, usize) -> DVec3) -> Mesh {
    let Size { columns, rows } = size;
    let vertex = |c: usize, r: usize| VertexId::new((r % rows) * columns + c % columns);
    let mut mesh = Mesh::default();
    for r in 0..rows {
        for c in 0..columns {
            mesh.positions.push(place(c, r).into());
            mesh.faces.extend(split(quad(c, r).map(|[c, r]| vertex(c, r))));
        }
    }
    mesh
}

/// Builds an open grid from `columns + 1` by `rows + 1` vertices `place(column, row)`.
///
/// Faces point along (direction of columns) × (direction of rows).
pub(crate) fn open(size: Size, place: impl Fn(usize, usize) -> DVec3) -> Mesh {
    let Size { columns, rows } = size;
    let vertex = |c: usize, r: usize| VertexId::new(r * (columns + 1) + c);
    let mut mesh = Mesh::default();
    for r in 0..=rows {
        for c in 0..=columns {
            mesh.positions.push(place(c, r).into());
        }
    }
    for r in 0..rows {
        for c in 0..columns {
            mesh.faces.extend(split(quad(c, r).map(|[c, r]| vertex(c, r))));
        }
    }
    mesh
}

/// Returns the column and row of each corner of a quad.
pub(crate) fn quad(column: usize, row: usize) -> [[usize; 2]; 4] {
    [[column, row], [column + 1, row], [column + 1, row + 1], [column, row + 1]]
}

/// Splits a quad along its first diagonal.
pub(crate) fn split<T: Copy>([a, b, c, d]: [T; 4]) -> [[T; 3]; 2] {
    [[a, b, c], [a, c, d]]
}
