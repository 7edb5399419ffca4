//! The `.mlod` file: the base mesh, followed by all updates in order of importance.
//!
//! Updates are grouped into chunks, and the chunks up to any point form a cut. A truncated file is
//! therefore usable: it only lacks its finer levels. The index near the front gives the position of
//! each chunk and the error that remains without it, so a query reads only the chunks it needs.
//! docs/formats/mlod.md specifies the bytes.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `archive`, `surroundings`, `container`, `source` | what callers open, query and read from |
//! | `layout`, `header`, `resources`, `attached` | sections of the file, its index, and bytes that others attach |
//! | `write` | from a forest to a file: start here for the encoder |
//! | `quantize`, `lattice`, `unflatten`, `chunk_plan` | numbers of fewer bits, and the order of updates in chunks |
//! | `base`, `chunk` | the two kinds of sections; `chunk::read` is the decoder |
//! | `decoder_state`, `child_offsets`, `normal_predictor` | what is known so far, and positions predicted from it |
//! | `exact_coding`, `stage_coding` | optional fields of updates |
//! | `wedge_state`, `wedge_names`, `wedge_records`, `lineage` | which wedge a face has at each corner |
//! | `layer_coding`, `coded_values`, `wedge_values` | attribute values as integers, and their residuals |
//! | `value_prediction`, `pair_values`, `octahedral_plane`, `slope` | predictions of these values |
//! | `residual_models`, `range_coder`, `streams`, `fixed_order` | entropy coding, and arithmetic that is the same everywhere |

mod archive;
mod attached;
mod base;
mod child_offsets;
mod chunk;
mod chunk_plan;
mod coded_values;
mod container;
mod decoder_state;
mod exact_coding;
mod fixed_order;
mod header;
mod lattice;
mod layer_coding;
mod layout;
mod lineage;
mod normal_predictor;
mod octahedral_plane;
mod pair_values;
mod quantize;
mod range_coder;
mod residual_models;
mod resources;
mod slope;
mod source;
mod stage_coding;
mod streams;
mod surroundings;
#[cfg(test)]
mod tests;
mod unflatten;
mod value_prediction;
mod wedge_names;
mod wedge_records;
mod wedge_state;
mod wedge_values;
mod write;

use std::io;

use thiserror::Error;

pub use archive::{Archive, Extract};
pub use container::{FieldParts, ModelFile};
pub(crate) use layer_coding::LayerCoding;
pub use resources::{Resource, pack_resource, unpack_resource};
pub use source::Source;
pub use surroundings::Surroundings;
pub use write::{Storage, StoredErrors};

use crate::cut::CertifyError;
use crate::forest::BuildError;
use crate::query::QueryError;
use crate::rtin::FieldBytesError;

const MAGIC: &[u8; 8] = b"meshlodm";
const VERSION: u32 = 1;

/// Reason why a multiresolution file cannot be read or written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileError {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The file does not start with the magic bytes of a multiresolution file.
    #[error("not a multiresolution file: it does not start with \"meshlodm\"")]
    Magic,
    /// The file has a format version that this program does not support.
    #[error("file version {0} is not supported: this program reads version {VERSION}")]
    Version(u32),
    /// The file ends before its base mesh or height field is complete.
    #[error("the file is truncated at byte {at}, before the end of {what}")]
    Truncated {
        /// Length of the file in bytes.
        at: u64,
        /// Name of the section that is incomplete.
        what: &'static str,
    },
    /// The checksum of a section of the file does not match its bytes.
    #[error("the checksum of {0} does not match: the file is damaged")]
    Checksum(String),
    /// Unexpected data follows the last chunk of the file.
    #[error("unexpected data after the last chunk, at byte {at}")]
    TrailingData {
        /// Offset at which the file should end.
        at: u64,
    },
    /// The file header has an invalid field.
    #[error("invalid header: {0}")]
    Header(&'static str),
    /// A section of the file decodes to invalid data.
    #[error("{section}: {why}")]
    Section {
        /// Name of the damaged section.
        section: String,
        /// Description of the problem.
        why: String,
    },
    /// The model fails certification: some cut of it would have a crack.
    #[error(transparent)]
    NotCertified(#[from] CertifyError),
    /// The requested rounding is negative, larger than the diagonal or not a number.
    #[error("the rounding must be between 0 and the diagonal of the mesh, not {0}")]
    Rounding(f64),
    /// A resource is too large.
    #[error("an image or the animations take 4 GiB or more, which the file cannot hold")]
    ResourcesTooLarge,
    /// The model could not be built from the simplification.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The height field cannot be encoded, or its bytes are invalid.
    #[error(transparent)]
    Field(#[from] FieldBytesError),
    /// The query is invalid; the file itself may be sound.
    #[error(transparent)]
    Query(#[from] QueryError),
}
