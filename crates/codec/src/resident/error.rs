//! Reasons why a mesh cannot be compressed.

use meshlod_mesh::MeshError;
use thiserror::Error;

use super::{MAX_FACES, MAX_VALUES};
use crate::blocks::BlocksError;
use crate::lattice::LatticeError;
use crate::parts::PartsError;

/// Reason why a mesh cannot be compressed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum CompressError {
    /// The mesh is invalid.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The mesh has no face with three different corners.
    #[error("the mesh has no faces")]
    Empty,
    /// An attribute value is infinite or NaN.
    #[error("layer \"{layer}\" has a value that is not finite at wedge {wedge}")]
    NotFinite {
        /// Name of the attribute layer that holds the value.
        layer: String,
        /// Index of the wedge that has the value.
        wedge: usize,
    },
    /// The mesh has more faces than a file can hold.
    #[error("the mesh has {0} faces, but a file holds at most {MAX_FACES}: split the mesh")]
    TooManyFaces(usize),
    /// The attributes have too many values per wedge, or the name of a layer is too long.
    #[error(
        "layer \"{0}\" does not fit: a wedge can have at most 255 values in a layer and {MAX_VALUES} in all, \
         and a layer name at most 65535 bytes"
    )]
    Layer(String),
    /// The requested number of bits is out of range.
    #[error("bits must be between 2 and 24, not {0}")]
    Bits(u32),
    /// The requested mean error is not positive and finite.
    #[error("the mean error must be a positive distance, not {0}")]
    Error(f64),
    /// The requested reduction of position storage is not between 0 and 1.
    #[error("the reduction must be between 0 and 1, not {0}")]
    Reduction(f64),
    /// The positions cannot be stored in parts.
    #[error(transparent)]
    Parts(#[from] PartsError),
    /// The positions cannot be stored on the lattice.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// The positions cannot be stored in blocks.
    #[error(transparent)]
    Blocks(#[from] BlocksError),
}
