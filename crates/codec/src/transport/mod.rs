//! Meshes to be sent or stored: the file `.mlz`.

mod border;
mod decode;
mod encode;
mod face_blocks;
mod file;
mod fit;
mod gate;
mod grid;
mod models;
mod predict;
mod rans;
#[cfg(test)]
mod tests;
mod walk;
mod weld_blocks;
mod write;

pub use file::{TransportBlock, TransportFile};
use meshlod_mesh::VertexId;
use thiserror::Error;

use self::border::MAX_FACES;
use self::grid::MAX_BITS;
use crate::lattice::Lattice;

/// A mesh in a file of blocks that are decoded alone.
#[derive(Clone, Debug)]
pub struct Transport {
    /// The file.
    pub bytes: Vec<u8>,
    /// How many blocks there are.
    pub blocks: usize,
    /// What takes how much of it.
    pub sizes: TransportSizes,
    /// What of the mesh is not in the file.
    pub left_out: Vec<LeftOut>,
}

/// What a mesh has and the file has not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeftOut {
    /// Normals, uvs and whatever else wedges have.
    Attributes,
    /// The materials of faces.
    Materials,
    /// The objects of faces.
    Objects,
    /// Vertices that no face uses.
    UnusedVertices,
}

/// Parts of a file, in bytes; together they are all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransportSizes {
    /// Where vertices are.
    pub positions: f64,
    /// What faces join, and which vertices of different blocks are one.
    pub connectivity: f64,
    /// Header, index, models, and the coder's state of each block.
    pub headers: f64,
}

/// How a mesh is put into a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransportOptions {
    /// What positions are rounded to.
    pub quantization: TransportQuantization,
    /// How many faces a block has, about: some have a quarter more.
    pub block_faces: usize,
}

/// Cubic cells that positions are rounded to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TransportQuantization {
    /// So many that their numbers along the longest side have these bits: 1 to 21.
    Bits(u32),
    /// Those of a lattice: what meshes share is in the same place in all of them.
    Lattice(Lattice),
}

impl Default for TransportOptions {
    fn default() -> Self {
        Self { quantization: TransportQuantization::Bits(11), block_faces: 256 }
    }
}

/// Why a mesh is not put into a file.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TransportError {
    /// Nothing to be sent.
    #[error("the mesh has no faces: there is nothing to put into blocks")]
    Empty,
    /// More than are numbered.
    #[error("{0} faces are too many for one file: cut the mesh")]
    TooMany(usize),
    /// A face of what is not there.
    #[error("a face has {0}, which is not there")]
    BadVertex(VertexId),
    /// A coordinate that `f32` does not have.
    #[error("{0} has a coordinate that is not finite, or beyond 1e38")]
    NotFinite(VertexId),
    /// Bits that cannot be.
    #[error("{0} bits for a coordinate cannot be: take 1 to {MAX_BITS}")]
    Bits(u32),
    /// More cells than are numbered.
    #[error(
        "the mesh spans {cells:.0} cells, more than {MAX_BITS} bits residuals: take larger ones"
    )]
    TooFine {
        /// How many.
        cells: f64,
    },
    /// CellVec that are not told apart.
    #[error(
        "the mesh is so far from the origin that cells are not residuals apart: take larger ones"
    )]
    TooFar,
    /// A block that is none.
    #[error("blocks of {0} faces cannot be: take 16 to {most}", most = max_block_faces())]
    Block(usize),
}

/// The greatest size that is asked for.
fn max_block_faces() -> usize {
    MAX_FACES * 4 / 5
}
