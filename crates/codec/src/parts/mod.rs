//! Vertex positions in 8 bits per axis, in parts of the mesh that share one grid [LCL10].

mod division;
mod face_graph;
mod grid;
mod lloyd;
mod merge;
mod packed;
mod partitioner;
mod stored;
#[cfg(test)]
mod tests;

use meshlod_mesh::{Bounds, FaceId, Mesh, VertexId};
use thiserror::Error;

pub use self::grid::Reconstruction;
use self::grid::SharedGrid;
pub(crate) use self::packed::PackedParts;
pub use self::partitioner::Partitioner;
pub use self::stored::{StoredPart, StoredParts};
use crate::bytes::reduction;

/// Mesh partitioned into parts, with vertex positions in 8 bits per axis.
///
/// Each part stores all its vertices. A vertex is in the same grid cell in all parts that have it.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    grid: SharedGrid,
    /// Number of mesh vertices that faces use.
    vertices: usize,
    parts: Vec<Part>,
}

/// Part of a mesh that spans at most 256 grid cells along each axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Cell of the shared grid at which the part's local cells start.
    pub offset: [i32; 3],
    /// Local cell of each vertex of the part, counted from the offset along each axis.
    pub positions: Vec<[u8; 3]>,
    /// Mesh vertex that each vertex of the part comes from.
    pub vertices: Vec<VertexId>,
    /// Faces of the part, as indices into its vertices.
    pub faces: Vec<[u32; 3]>,
    /// Mesh face that each face of the part comes from.
    pub ids: Vec<FaceId>,
}

/// Reason why a mesh cannot be partitioned.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum PartsError {
    /// The mesh has no face with three different corners.
    #[error("the mesh has no faces")]
    Empty,
    /// A coordinate is infinite, NaN, or too large for `f32`.
    #[error("{0} has a coordinate that is not finite or is too large for f32")]
    NotFinite(VertexId),
    /// The requested reduction of position storage is not between 0 and 1.
    #[error("the reduction must be between 0 and 1, not {0}")]
    Reduction(f64),
    /// The mesh is too small for the requested reduction of position storage.
    #[error("the mesh is too small: the largest possible reduction is {best:.3}, in one part")]
    TooSmall {
        /// Largest reduction of position storage that is possible for this mesh.
        best: f64,
    },
}

/// Size of the header in a file: flags, number of vertices and parts, and the sides of a cell.
const HEADER: usize = 1 + 2 * 4 + 3 * 4;
/// Size of a part's number of vertices; its offset takes 16 or 32 bits per axis.
const PART: usize = 4;

impl Parts {
    /// Returns the parts into which the mesh is partitioned.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Returns the number of mesh vertices that faces use.
    pub fn vertices(&self) -> usize {
        self.vertices
    }

    /// Returns the sides of a grid cell along x, y and z, in model units.
    pub fn cell(&self) -> [f32; 3] {
        self.grid.cell()
    }

    /// Returns the mean side of a cell.
    pub(crate) fn mean_side(&self) -> f64 {
        self.grid.mean_side()
    }

    /// Returns the matrix that maps the local cells of a part to model units, as three rows of
    /// four.
    pub fn matrix(&self, part: &Part) -> [[f32; 4]; 3] {
        self.grid.matrix(part)
    }

    /// Decodes the whole mesh, with each vertex once although several parts may store it.
    ///
    /// Vertices are in the order of their first part; faces come part by part.
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

    /// Returns the compressed size of the positions in bytes, with everything needed to decode
    /// them.
    pub fn position_bytes(&self) -> usize {
        HEADER + self.parts.len() * self.part_header() + 3 * self.stored()
    }

    fn part_header(&self) -> usize {
        let offsets: Vec<_> = self.parts.iter().map(|part| part.offset).collect();
        part_header(&offsets)
    }

    /// Returns the number of vertices of all parts together.
    fn stored(&self) -> usize {
        self.parts.iter().map(|part| part.positions.len()).sum()
    }

    /// Returns the fraction of position storage saved, compared with three `f32` for each vertex.
    pub fn reduction(&self) -> f64 {
        reduction(self.position_bytes(), self.vertices)
    }

    /// Returns the number of vertices stored repeatedly by several parts, as a fraction of all
    /// vertices.
    pub fn overhead(&self) -> f64 {
        self.stored() as f64 / self.vertices as f64 - 1.0
    }
}

/// Returns the size of a part's header.
fn part_header(offsets: &[[i32; 3]]) -> usize {
    let is_short = offsets.as_flattened().iter().all(|&x| i16::try_from(x).is_ok());
    PART + if is_short { 6 } else { 12 }
}

/// Returns the longest side of a box.
fn longest_side(bounds: &Bounds) -> f64 {
    (0..3).map(|axis| bounds.max[axis] - bounds.min[axis]).fold(0.0, f64::max)
}
