//! Accuracy asked for, the report of what was reached, and errors.

use meshlod_mesh::VertexId;
use thiserror::Error;

/// Requested accuracy of decoded positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accuracy {
    /// As accurate as a uniform grid over the whole mesh with this many bits per axis.
    ///
    /// The grid has 2^bits − 1 cubic cells along the longest side.
    Bits(u32),
    /// Mean distance between the original and the decoded surface, in model units.
    Error(f64),
}

impl Accuracy {
    /// Returns the next lower accuracy: a bit less, or a quarter of a bit.
    pub(crate) fn coarser(self) -> Option<Self> {
        match self {
            Self::Bits(bits) => (bits > 2).then_some(Self::Bits(bits - 1)),
            Self::Error(error) => Some(Self::Error(error * f64::exp2(0.25))),
        }
    }
}

/// Error of a mesh stored in vertex blocks, next to that of a uniform grid with the same mean
/// error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct BlocksReport {
    /// Error of the surface decoded from the blocks.
    pub blocks: SurfaceChange,
    /// Error of the surface rounded to the cubic cells of the uniform grid.
    pub cubes: SurfaceChange,
    /// Side of a cubic cell of the uniform grid, in model units.
    pub cube_side: f64,
    /// Number of blocks that were refined to avoid a flipped face or a distant vertex.
    pub refined_blocks: usize,
}

/// Difference between a decoded surface and the original, estimated from the faces around each
/// vertex.
///
/// Lengths are in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SurfaceChange {
    /// Mean distance of the decoded surface's points from the planes of their original faces, in
    /// model units.
    pub error_estimate: f64,
    /// Largest distance of a vertex from the other surface, in model units.
    pub max_estimate: f64,
    /// Number of faces that turned by more than 90° or collapsed to zero area.
    pub flips: usize,
}

/// Reason why a mesh cannot be stored in blocks.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum BlocksError {
    /// A coordinate is infinite, NaN, or too large for `f32`.
    #[error("{0} has a coordinate that is not finite or is beyond 1e38")]
    NotFinite(VertexId),
    /// The requested number of bits is out of range.
    #[error("bits must be between 2 and 24, not {0}")]
    Bits(u32),
    /// The requested mean distance is not positive and finite.
    #[error("the mean error must be a positive distance, not {0}")]
    Error(f64),
    /// The requested mean distance would take more cells than can be numbered.
    #[error("a mean error of {0:e} would take more than 24 bits per axis: allow a larger error")]
    TooFine(f64),
}
