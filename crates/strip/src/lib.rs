//! Triangle strips that follow the level.
//!
//! [`Strips`] are what a GPU draws as strips: sequences of vertices, every three in a row a triangle, every
//! second one turned. [`difference`] says whether they draw exactly the triangles of a mesh.

#![forbid(unsafe_code)]

mod anneal;
mod cover;
mod dual;
mod emit;
mod energy;
mod even;
mod filter;
mod greedy;
mod measure;
mod oddities;
mod order;
mod overdraw;
mod pieces;
mod random;
mod region;
mod repair;
mod selective;
mod sequence;
mod skip;
mod stripify;
mod strips;
mod trail;
mod verify;

pub use energy::Prices;
pub use filter::Filter;
pub use measure::{StripStatistics, acmr};
pub use oddities::Oddities;
pub use overdraw::overdraw;
pub use pieces::CacheAware;
pub use repair::{Effort, LevelStrips, LiveStrips};
pub use selective::{CutStrips, PointsMove};
pub use skip::{HistoryError, MergeTree, SkipStrip};
pub use stripify::{Options, Quality, stripify};
pub use strips::Strips;
pub use verify::{Difference, difference};
