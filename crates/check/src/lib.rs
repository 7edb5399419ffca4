//! What is wrong with a mesh, where its objects touch, what can be mended, what must not move.
#![forbid(unsafe_code)]

mod finding;
mod objects;
mod places;

pub use finding::{Degeneracy, Finding, Kind, Severity, Touch, TouchKind};
pub use objects::{ObjectId, Objects, ObjectsBy};
pub use places::Places;
