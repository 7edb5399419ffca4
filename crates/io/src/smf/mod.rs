//! Simple model format of QSlim: vertices and faces as in OBJ, properties bound to either, scopes
//! with transformations.

mod read;
mod scope;
mod write;

pub use read::read;
pub use write::write;
