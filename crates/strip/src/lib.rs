//! Triangle strips that follow the level.
//!
//! [`Strips`] are what a GPU draws as strips: sequences of vertices, every three in a row a triangle, every
//! second one turned. [`difference`] says whether they draw exactly the triangles of a mesh.
//!
//! [`stripify`] makes strips of any faces: fast ones in one pass, or the best that a path cover of the dual graph can
//! be annealed to; and cuts and orders them for a vertex cache if it is asked to. [`StripStatistics`] say what they
//! send.
//!
//! ```
//! use meshlod_samples as samples;
//! use meshlod_strip::{Options, Quality, StripStatistics, difference, stripify};
//!
//! let faces = samples::sphere(1000).faces;
//! let fast = stripify(&faces, &Options { quality: Quality::Fast, ..Options::default() });
//! let best = stripify(&faces, &Options::default());
//! assert_eq!(difference(&best, &faces), Default::default());
//! assert!(best.vertices().len() <= fast.vertices().len());
//! assert!(StripStatistics::new(&best).vertices_sent < faces.len() * 5 / 4);
//! ```
//!
//! A [`SkipStrip`] leads the strips of a mesh down the half-edge contractions of a [`MergeTree`]: to every level its
//! display strips, shortened by a [`Filter`] or [repaired](SkipStrip::repaired). [`LevelStrips`] and [`CutStrips`] follow
//! levels and cuts for the price of what changes. docs/notes/strips.md tells how.

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
pub use overdraw::overdraw;
pub use pieces::CacheAware;
pub use repair::{Effort, LevelStrips, LiveStrips};
pub use selective::{CutStrips, PointsMove};
pub use skip::{HistoryError, MergeTree, SkipStrip};
pub use stripify::{Options, Quality, stripify};
pub use strips::Strips;
pub use verify::{Difference, difference};
