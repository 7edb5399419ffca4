//! Files of every kind that we read and write, and where output goes.

#[cfg(feature = "codec")]
mod any_file;
#[cfg(feature = "codec")]
mod compressed;
mod kind;
mod output;
#[cfg(feature = "codec")]
mod source;

#[cfg(feature = "codec")]
pub use any_file::{AnyFile, AnyFileError};
pub use kind::FileKind;
pub use output::Output;
pub(crate) use output::limits;
#[cfg(feature = "codec")]
pub use source::FileBytes;
