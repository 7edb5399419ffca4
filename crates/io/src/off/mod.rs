//! Object File Format (OFF), including Geomview's variants with vertex normals (NOFF), colours
//! (COFF), texture coordinates (STOFF) or several of them.

mod read;
mod vertex_format;
mod write;

pub use read::{read, read_scene};
pub use write::write;
pub(crate) use write::write_commented;
