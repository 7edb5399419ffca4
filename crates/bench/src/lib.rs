//! Comparisons with other programs: both perform one task in alternating rounds, so that other load
//! on the machine affects both alike. The laboratory makes the figures of docs/RESULTS.md by them.
mod alternate;
mod corpus;
mod lab;
pub mod peer;

pub use alternate::{Ratio, alternate, least_seconds, one_core};
pub use corpus::{read, read_scene};
pub use lab::lab;
pub use meshlod_fixtures::{self as fixtures, shared_mesh, shared_meshes};
