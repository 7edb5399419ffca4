//! The `.mlod` file: a base mesh, and then all updates, the ones that matter most first.
//!
//! Updates stand in chunks. All chunks up to any one are a cut: so a file is good from its start on, and
//! what has not come yet is only missing. An index near the front tells of each chunk where it is and how
//! coarse things are without it: a query reads what it needs. docs/formats/mlod.md has the bytes.

mod archive;
mod base;
mod child_offsets;
mod chunk;
mod chunk_plan;
mod container;
mod decoder_state;
mod exact_positions;
mod header;
mod lattice;
mod normal_predictor;
mod quantize;
mod source;
mod streams;
#[cfg(test)]
mod tests;
mod unflatten;
mod write;

use std::io;

use thiserror::Error;

pub use archive::{Archive, Extract};
pub use container::ModelFile;
pub use source::Source;
pub use write::Storage;

use crate::cut::CertifyError;
use crate::forest::BuildError;
use crate::query::QueryError;
use crate::rtin::FieldBytesError;

const MAGIC: &[u8; 8] = b"meshlodm";
const VERSION: u32 = 1;

/// Why a file gives no model.
#[derive(Debug, Error)]
pub enum FileError {
    /// It cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It starts otherwise.
    #[error("this is no multiresolution file: it does not start with \"meshlodm\"")]
    Magic,
    /// It was written by a later version.
    #[error("version {0} of multiresolution files; this program reads version {VERSION}")]
    Version(u32),
    /// It ends before its coarsest mesh does.
    #[error("the file is cut off at byte {at}, before the end of {what}")]
    Truncated {
        /// How long it is.
        at: u64,
        /// What is not there as a whole.
        what: &'static str,
    },
    /// It is not what was written.
    #[error("the checksum of {0} is wrong: the file is damaged")]
    Checksum(String),
    /// It goes on.
    #[error("byte {at}: the last chunk is over, the file goes on")]
    TrailingData {
        /// Where it should end.
        at: u64,
    },
    /// Its header cannot be.
    #[error("the header: {0}")]
    Header(&'static str),
    /// A piece of it cannot be.
    #[error("{section}: {why}")]
    Section {
        /// Which.
        section: String,
        /// What is wrong with it.
        why: String,
    },
    /// Its meshes would have cracks.
    #[error(transparent)]
    NotCertified(#[from] CertifyError),
    /// A rounding below 0, beyond the diagonal, or none.
    #[error("vertices cannot be moved by up to {0}: give at least 0 and at most the diagonal")]
    Rounding(f64),
    /// There is no model to write.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A height field that cannot be written, or is none.
    #[error(transparent)]
    Field(#[from] FieldBytesError),
    /// Not the file is wrong but the question.
    #[error(transparent)]
    Query(#[from] QueryError),
}
