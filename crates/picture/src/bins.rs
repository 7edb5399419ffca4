//! Sorting of faces into picture tiles before rasterization.

use meshlod_mesh::Mesh;
use rayon::prelude::*;

use crate::camera::Lens;
use crate::clip::clip;
use crate::culling::Culling;
use crate::project::{Point, Projected, outcode, project};
use crate::raster::SampleRect;

/// A face that touches more tiles than this is stored once and tested by every tile, which bounds
/// the memory per face.
const MAX_TILES: i32 = 16;

/// Minimum number of faces binned by one task.
const CHUNK: usize = 1 << 16;

/// Grid of samples of a picture, cut into square tiles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tiling {
    /// Number of samples across and down.
    pub size: [u32; 2],
    /// Side of a tile, in samples.
    pub side: u32,
}

impl Tiling {
    pub(crate) fn columns(&self) -> u32 {
        self.size[0].div_ceil(self.side)
    }

    pub(crate) fn count(&self) -> usize {
        (self.columns() * self.size[1].div_ceil(self.side)) as usize
    }

    /// Returns the samples of a tile; tiles are numbered row by row.
    pub(crate) fn window(&self, tile: usize) -> SampleRect {
        let [column, row] = [tile as u32 % self.columns(), tile as u32 / self.columns()];
        let start = [column * self.side, row * self.side];
        let end = [0, 1].map(|axis| (start[axis] + self.side).min(self.size[axis]) as i32);
        SampleRect { start: start.map(|s| s as i32), end }
    }

    fn whole(&self) -> SampleRect {
        SampleRect { start: [0, 0], end: self.size.map(|s| s as i32) }
    }
}

/// Faces of a mesh, projected and binned by tile, without those that are culled.
///
/// Memory: 16 bytes a vertex, 4 bytes per face and tile for small faces, 40 bytes for a large one.
pub(crate) struct Bins<'a> {
    mesh: &'a Mesh,
    tiling: Tiling,
    vertices: Vec<Projected>,
    chunks: Vec<Chunk>,
}

/// Bins of a range of consecutive faces.
struct Chunk {
    /// Start of each tile's faces in `faces`.
    starts: Vec<u32>,
    faces: Vec<u32>,
    /// Large faces and pieces of clipped ones, with the index of the face.
    loose: Vec<(u32, [Point; 3])>,
}

impl<'a> Bins<'a> {
    pub(crate) fn new(mesh: &'a Mesh, lens: &Lens, tiling: Tiling, culling: Culling<'_>) -> Self {
        let vertices = project(&mesh.positions, lens, tiling.size);
        // At least as many faces as tiles, so that `starts` stays small beside `faces`.
        let length = CHUNK.max(tiling.count());
        let chunk_of = |i: usize| {
            let faces = i * length..mesh.faces.len().min((i + 1) * length);
            Chunk::new(mesh, &vertices, lens, tiling, culling, faces)
        };
        let chunks = mesh.faces.len().div_ceil(length);
        let chunks = (0..chunks).into_par_iter().map(chunk_of).collect();
        Self { mesh, tiling, vertices, chunks }
    }

    /// Visits every triangle that may touch a tile, with its face.
    pub(crate) fn visit(&self, tile: usize, mut visit: impl FnMut(u32, &[Point; 3])) {
        let window = self.tiling.window(tile);
        for chunk in &self.chunks {
            for &face in &chunk.faces[chunk.starts[tile] as usize..chunk.starts[tile + 1] as usize]
            {
                let corners = self.mesh.faces[face as usize];
                visit(face, &corners.map(|v| self.vertices[v.index()].point));
            }
            for (face, triangle) in &chunk.loose {
                if !window.clipped_to(triangle).is_empty() {
                    visit(*face, triangle);
                }
            }
        }
    }
}

impl Chunk {
    fn new(
        mesh: &Mesh,
        vertices: &[Projected],
        lens: &Lens,
        tiling: Tiling,
        culling: Culling<'_>,
        faces: std::ops::Range<usize>,
    ) -> Self {
        let whole = tiling.whole();
        let (mut touches, mut loose) = (Vec::new(), Vec::new());
        for face in faces {
            let corners = mesh.faces[face];
            let [a, b, c] = corners.map(|v| vertices[v.index()]);
            if a.outcode & b.outcode & c.outcode != 0 {
                continue;
            }
            if (a.outcode | b.outcode | c.outcode) & outcode::CLIP != 0 {
                let corners = mesh.triangle(corners).map(|p| lens.project(p));
                clip(corners, lens.near(), |piece| {
                    if !culling.hides(face, &piece) {
                        loose.push((face as u32, piece));
                    }
                });
                continue;
            }
            let triangle = [a.point, b.point, c.point];
            let samples = whole.clipped_to(&triangle);
            if samples.is_empty() || culling.hides(face, &triangle) {
                continue;
            }
            let side = tiling.side as i32;
            let [left, top] = samples.start.map(|s| s / side);
            let [right, bottom] = samples.end.map(|s| (s - 1) / side);
            if (right - left + 1) * (bottom - top + 1) > MAX_TILES {
                loose.push((face as u32, triangle));
                continue;
            }
            for (row, column) in (top..=bottom).flat_map(|y| (left..=right).map(move |x| (y, x))) {
                touches.push((row as u32 * tiling.columns() + column as u32, face as u32));
            }
        }
        let (starts, faces) = group(&touches, tiling.count());
        Self { starts, faces, loose }
    }
}

/// Groups values by key, keeping their order; returns where each key's values start, and the
/// values.
fn group(pairs: &[(u32, u32)], keys: usize) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0; keys + 1];
    for &(key, _) in pairs {
        starts[key as usize + 1] += 1;
    }
    for key in 0..keys {
        starts[key + 1] += starts[key];
    }
    let mut next = starts.clone();
    let mut values = vec![0; pairs.len()];
    for &(key, value) in pairs {
        values[next[key as usize] as usize] = value;
        next[key as usize] += 1;
    }
    (starts, values)
}
