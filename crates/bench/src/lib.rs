//! Comparisons with other programs: both perform one task in alternating rounds, so that other load
//! on the machine affects both alike.
mod alternate;
mod corpus;
pub mod peer;

pub use alternate::{Ratio, alternate, least_seconds, one_core};
pub use corpus::{read, read_scene};
pub use meshlod_fixtures::{self as fixtures, shared_mesh, shared_meshes};
