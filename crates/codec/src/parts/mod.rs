//! Eight bits an axis, in parts that share one grid [LCL10].

mod face_graph;
mod grid;
mod lloyd;
mod merge;
mod packed;
mod partitioner;
#[cfg(test)]
mod tests;

use meshlod_mesh::{Bounds, FaceId, Mesh, VertexId};
use thiserror::Error;

pub use self::grid::Reconstruction;
use self::grid::SharedGrid;
pub(crate) use self::packed::PackedParts;
pub use self::partitioner::Partitioner;
use crate::bytes::reduction;

/// The positions and faces of a mesh in parts, positions in eight bits an axis.
///
/// A vertex is stored once for each part that uses it. It is in the same cell of the grid in all of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    grid: SharedGrid,
    /// How many vertices the mesh has that faces use.
    vertices: usize,
    parts: Vec<Part>,
}

/// A part: at most 256 cells along each axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// The cell of the grid in which its own cell `[0; 3]` is.
    pub offset: [i32; 3],
    /// The cells of its vertices, from its offset on.
    pub positions: Vec<[u8; 3]>,
    /// The vertex of the mesh that each is.
    pub vertices: Vec<VertexId>,
    /// By places in these lists.
    pub faces: Vec<[u32; 3]>,
    /// The face of the mesh that each is.
    pub ids: Vec<FaceId>,
}

/// Why a mesh is not made parts.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PartsError {
    /// No face has three corners.
    #[error("the mesh has no faces to part")]
    Empty,
    /// A number that is none.
    #[error("{0} has a coordinate that is not finite, or too large")]
    NotFinite(VertexId),
    /// Not a part between nothing and all.
    #[error("a reduction of {0} is none: give a part between 0 and 1")]
    Reduction(f64),
    /// The mesh is too small for its headers.
    #[error("so small a mesh is reduced by {best:.3} at most, in one part")]
    TooSmall {
        /// What there is.
        best: f64,
    },
}

/// Of a file: its flags, how many vertices and parts it has, and the sides of a cell.
const HEADER: usize = 1 + 2 * 4 + 3 * 4;
/// Of a part: how many vertices it has, and its offset in 16 bits an axis or in 32.
const PART: usize = 4;

impl Parts {
    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// How many vertices of the mesh they have.
    pub fn vertices(&self) -> usize {
        self.vertices
    }

    /// The sides of a cell, in model units.
    pub fn cell(&self) -> [f32; 3] {
        self.grid.cell()
    }

    /// Their mean.
    pub(crate) fn mean_side(&self) -> f64 {
        self.cell().iter().map(|&side| f64::from(side)).sum::<f64>() / 3.0
    }

    /// What puts a part's positions where they belong: three rows of four, model units.
    pub fn matrix(&self, part: &Part) -> [[f32; 4]; 3] {
        self.grid.matrix(part)
    }

    /// The mesh of all parts: each vertex where its cell is, each once.
    ///
    /// Vertices are in the order in which parts have them; faces part by part.
    pub fn decode(&self) -> Mesh {
        let most = self.parts.iter().flat_map(|part| &part.vertices).max();
        let mut numbers = vec![None; most.map_or(0, |v| v.index() + 1)];
        let mut mesh = Mesh::default();
        for part in &self.parts {
            for (&vertex, &position) in part.vertices.iter().zip(&part.positions) {
                numbers[vertex.index()].get_or_insert_with(|| {
                    mesh.positions.push(self.grid.place(part.offset, position));
                    VertexId::new(mesh.positions.len() - 1)
                });
            }
            let number = |local: u32| numbers[part.vertices[local as usize].index()];
            mesh.faces.extend(
                part.faces
                    .iter()
                    .filter_map(|&[a, b, c]| Some([number(a)?, number(b)?, number(c)?])),
            );
        }
        mesh
    }

    /// What positions take, with all that decoding them needs, in bytes.
    pub fn position_bytes(&self) -> usize {
        HEADER + self.parts.len() * self.part_header() + 3 * self.stored()
    }

    fn part_header(&self) -> usize {
        let offsets: Vec<_> = self.parts.iter().map(|part| part.offset).collect();
        part_header(&offsets)
    }

    /// How many vertices all parts have together.
    fn stored(&self) -> usize {
        self.parts.iter().map(|part| part.positions.len()).sum()
    }

    /// How many parts would leave a reduction, as far as these tell: vertices are stored again along borders,
    /// whose length grows as the root of the number of parts.
    fn count_for(&self, reduction: f64) -> usize {
        let (count, header) = (self.parts.len() as f64, self.part_header() as f64);
        let again = (self.stored() - self.vertices).max(1) as f64 / count.sqrt();
        let room = (1.0 - reduction) * (12 * self.vertices) as f64;
        let room = room - (HEADER + 3 * self.vertices) as f64;
        // header · x² + 3 again · x = room, where x is the root.
        let half = 1.5 * again / header;
        let root = (half * half + room.max(0.0) / header).sqrt() - half;
        (root * root) as usize
    }

    /// How much less that is than three `f32` for each vertex, as a part.
    pub fn reduction(&self) -> f64 {
        reduction(self.position_bytes(), self.vertices)
    }

    /// How many vertices are stored again, as a part of all.
    pub fn overhead(&self) -> f64 {
        self.stored() as f64 / self.vertices as f64 - 1.0
    }
}

/// What each part takes beside its positions.
fn part_header(offsets: &[[i32; 3]]) -> usize {
    let is_short = offsets.as_flattened().iter().all(|&x| i16::try_from(x).is_ok());
    PART + if is_short { 6 } else { 12 }
}

/// The longest side of a box.
fn longest_side(bounds: &Bounds) -> f64 {
    (0..3).map(|axis| bounds.max[axis] - bounds.min[axis]).fold(0.0, f64::max)
}
