//! Object File Format (OFF), including the variants of Geomview with normals, colours and texture
//! coordinates at the vertices: NOFF, COFF, STOFF and their combinations.

mod read;
mod write;

pub use read::read;
pub use write::write;
