//! Triangle strips that follow the level.
//!
//! [`Strips`] are what a GPU draws as strips: sequences of vertices, every three in a row a triangle, every
//! second one turned. [`difference`] says whether they draw exactly the triangles of a mesh.

#![forbid(unsafe_code)]

mod filter;
mod skip;
mod strips;
mod verify;

pub use filter::Filter;
pub use skip::{HistoryError, MergeTree, SkipStrip};
pub use strips::Strips;
pub use verify::{Difference, difference};
