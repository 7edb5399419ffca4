//! Regular grids of quads, each split into two faces.

use glam::DVec3;

use meshlod_mesh::{Mesh, VertexId};

/// How many quads each way: `columns` first, `rows` second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Size {
    pub columns: usize,
    pub rows: usize,
}

impl Size {
    /// About `faces / 2` quads, `aspect` times as many columns as rows, at least 3 each way.
    ///
    /// `2 * columns * rows` is within `rows` of `faces` from 18 faces on.
    pub fn for_faces(faces: usize, aspect: f64) -> Self {
        let quads = faces as f64 / 2.0;
        let rows = (quads / aspect).sqrt().round().max(3.0);
        let columns = (quads / rows).round().max(3.0);
        Self { columns: columns as usize, rows: rows as usize }
    }
}

/// A grid closed both ways, as a torus is; `place(column, row)` gives the vertices.
///
/// A face looks along (direction of columns) × (direction of rows).
pub(super) fn wrapped(size: Size, place: impl Fn(usize, usize) -> DVec3) -> Mesh {
    let Size { columns, rows } = size;
    let vertex = |c: usize, r: usize| VertexId::new((r % rows) * columns + c % columns);
    let mut mesh = Mesh::default();
    for r in 0..rows {
        for c in 0..columns {
            mesh.positions.push(place(c, r).into());
            let quad = [vertex(c, r), vertex(c + 1, r), vertex(c + 1, r + 1), vertex(c, r + 1)];
            mesh.faces.extend(split(quad));
        }
    }
    mesh
}

/// An open grid of `columns + 1` by `rows + 1` vertices; `place(column, row)` gives them.
///
/// A face looks along (direction of columns) × (direction of rows).
pub(super) fn open(size: Size, place: impl Fn(usize, usize) -> DVec3) -> Mesh {
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
            let quad = [vertex(c, r), vertex(c + 1, r), vertex(c + 1, r + 1), vertex(c, r + 1)];
            mesh.faces.extend(split(quad));
        }
    }
    mesh
}

/// The two faces of a quad, by its first diagonal.
pub(super) fn split<T: Copy>([a, b, c, d]: [T; 4]) -> [[T; 3]; 2] {
    [[a, b, c], [a, c, d]]
}
