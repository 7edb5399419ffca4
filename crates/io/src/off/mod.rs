//! Object file format: OFF, and with normals, colours and texture coordinates at the vertices
//! NOFF, COFF, STOFF and their combinations, as Geomview has them.

mod read;
mod write;

pub use read::read;
pub use write::write;
