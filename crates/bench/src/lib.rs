//! meshlod beside its peers: the same work by turns in one run, so that whatever else the machine
//! does falls on both.
mod alternate;
mod corpus;
pub mod peer;

pub use alternate::{Ratio, alternate, least_seconds, one_core};
pub use corpus::{read, read_scene};
pub use meshlod_fixtures::shared_mesh;
