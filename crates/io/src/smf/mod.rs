//! Simple Model Format (SMF) of QSlim: vertices and faces as in OBJ, their properties, and nested
//! scopes with transformations.

mod read;
mod scope;
mod write;

pub use read::{read, read_scene};
pub use write::write;
pub(crate) use write::write_commented;
