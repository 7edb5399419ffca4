//! Entropy-coded meshes for sending and storing: `.mlz` files.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `write` | from a mesh to a file: start here for the encoder |
//! | `grid`, `face_blocks` | cells of positions, and faces in blocks |
//! | `walk`, `border`, `gate` | the order of a block: one face after the other across an edge |
//! | `fans` | the faces around a vertex as one symbol |
//! | `predict`, `lanes` | where the next vertex is, for four blocks at a time |
//! | `models`, `fit` | probabilities of a file, fitted to its mesh |
//! | `encode`, `rans`, `encoded_layers`, `layers` | symbols, and attributes after positions |
//! | `header`, `file` | the index of blocks, and a file that is open |
//! | `decode`, `read` | a block from bytes nobody vouches for |
//! | `weld_blocks`, `gather` | the mesh from its blocks |
//! | `symbol_bits` | what each part takes |

mod border;
mod decode;
mod encode;
mod encoded_layers;
mod face_blocks;
mod fans;
mod file;
mod fit;
mod gate;
mod gather;
mod grid;
mod header;
#[cfg(test)]
mod hostile_layer_tests;
mod lanes;
#[cfg(test)]
mod layer_tests;
mod layers;
mod models;
mod predict;
mod rans;
mod read;
mod symbol_bits;
#[cfg(test)]
mod tests;
mod walk;
mod weld_blocks;
mod write;

pub use file::TransportFile;
use meshlod_mesh::{AttributeBounds, MeshError, VertexId};
use thiserror::Error;

use self::border::MAX_FACES;
use self::grid::MAX_BITS;
use crate::attributes::LayerReport;
use crate::lattice::Lattice;

/// Encoded `.mlz` file, whose blocks can be decoded independently.
#[derive(Clone, Debug)]
pub struct Transport {
    /// Contents of the `.mlz` file.
    pub bytes: Vec<u8>,
    /// Number of vertices in the file.
    pub vertices: usize,
    /// Number of faces in the file.
    pub faces: usize,
    /// Number of independently decodable blocks in the file.
    pub blocks: usize,
    /// Size of the `.mlz` file by content, in bytes.
    pub sizes: TransportSizes,
    /// Size and largest error of each attribute layer.
    pub layers: Vec<LayerReport>,
    /// Number of vertices of the input mesh that the file does not store: no face uses them.
    pub unused_vertices: usize,
}

/// Size of an `.mlz` file by content, in bytes; the numbers add up to the whole file.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct TransportSizes {
    /// Size of the vertex positions, in bytes.
    pub positions: f64,
    /// Size of the vertex indices of all faces, with the welding of blocks, in bytes.
    pub connectivity: f64,
    /// Size of attributes, and of the materials and objects of faces, in bytes.
    pub attributes: f64,
    /// Size of what was given as resources, in bytes.
    pub resources: usize,
    /// Size of everything else in bytes: header, index, models, and the coder's final state of each
    /// block.
    pub headers: f64,
}

/// Options of [`Transport::encode`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct TransportOptions {
    /// Grid to which vertex positions are rounded.
    pub quantization: TransportQuantization,
    /// Approximate number of faces per block; some blocks have a quarter more.
    pub block_faces: usize,
    /// Largest errors of attributes.
    pub attributes: AttributeBounds,
}

/// Limit on the attribute values of a wedge over all layers.
const MAX_LAYER_VALUES: usize = 1023;
/// Limit on the number of layers, which takes a byte.
const MAX_LAYERS: usize = 255;

/// Grid of cubic cells to which vertex positions are rounded.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum TransportQuantization {
    /// Uniform grid over the mesh with 2^bits − 1 cells along its longest side, for 1 to 21 bits.
    Bits(u32),
    /// Cells of a lattice: vertices that several meshes share decode to the same place in all of
    /// them.
    Lattice(Lattice),
}

impl Default for TransportOptions {
    fn default() -> Self {
        let attributes = AttributeBounds::default();
        Self { quantization: TransportQuantization::Bits(11), block_faces: 320, attributes }
    }
}

/// Reason why a mesh cannot be encoded for transport.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum TransportError {
    /// The mesh has no faces.
    #[error("the mesh has no faces")]
    Empty,
    /// The mesh has more faces than the format can number.
    #[error("the mesh has {0} faces, too many for one file: split the mesh")]
    TooMany(usize),
    /// A face uses a vertex that does not exist.
    #[error("a face uses {0}, which does not exist")]
    BadVertex(VertexId),
    /// A coordinate is infinite, NaN, or too large for `f32`.
    #[error("{0} has a coordinate that is not finite or is beyond 1e38")]
    NotFinite(VertexId),
    /// The requested number of bits is out of range.
    #[error("bits must be between 1 and {MAX_BITS}, not {0}")]
    Bits(u32),
    /// The mesh spans more grid cells than the format can number.
    #[error(
        "the mesh spans {cells:.0} cells, more than {MAX_BITS} bits can number: use larger cells"
    )]
    TooFine {
        /// Number of grid cells along the longest side of the mesh.
        cells: f64,
    },
    /// The mesh is so far from the origin that neighbouring cells coincide in `f64`.
    #[error("the mesh is too far from the origin for cells of this size: use larger cells")]
    TooFar,
    /// Attributes, materials or objects do not match the mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// An attribute layer has too many values, or its name is too long.
    #[error(
        "attribute layer \"{0}\" does not fit: a file holds {MAX_LAYERS} layers, of 255 values \
         per wedge each and {MAX_LAYER_VALUES} in all"
    )]
    Layer(String),
    /// An attribute value is infinite or NaN.
    #[error("attribute layer \"{layer}\": wedge {wedge} has a value that is not finite")]
    NotFiniteValue {
        /// Name of the attribute layer.
        layer: String,
        /// Index of the wedge.
        wedge: usize,
    },
    /// The requested number of faces per block is out of range.
    #[error("faces per block must be between 16 and {most}, not {0}", most = max_block_faces())]
    Block(usize),
}

/// Returns the largest block size that can be requested.
fn max_block_faces() -> usize {
    MAX_FACES * 4 / 5
}
