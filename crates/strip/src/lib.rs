//! Triangle strips for meshes and for all their levels of detail.
//!
//! [`Strips`] hold strips as a GPU draws them: vertex sequences in which every three consecutive
//! vertices form a triangle, every second one with reversed winding. [`difference`] checks that
//! they draw exactly the triangles of a mesh.
//!
//! [`stripify`] builds strips from any list of faces: greedily in one pass, or by annealing a path
//! cover of the dual graph. On request it cuts and orders them for a vertex cache.
//! [`StripStatistics`] count the vertices and indices sent.
//!
//! ```
//! use meshlod_samples as samples;
//! use meshlod_strip::{StripOptions, StripQuality, StripStatistics, difference, stripify};
//!
//! let faces = samples::sphere(1000).faces;
//! let options = StripOptions { quality: StripQuality::Fast, ..StripOptions::default() };
//! let fast = stripify(&faces, &options);
//! let best = stripify(&faces, &StripOptions::default());
//! assert_eq!(difference(&best, &faces), Default::default());
//! assert!(best.vertices().len() <= fast.vertices().len());
//! assert!(StripStatistics::new(&best).vertices_sent < faces.len() * 5 / 4);
//! ```
//!
//! A [`SkipStrip`] carries the strips of a mesh down the half-edge contractions of a [`MergeTree`].
//! It gives display strips for every level, shortened by a [`Filter`] or
//! [repaired](SkipStrip::repaired). [`LevelStrips`] and [`CutStrips`] follow levels and cuts at a
//! cost proportional to the change, and [`StripIndices`] are index buffers that follow those. See
//! docs/notes/strips.md.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `strips`, `sequence`, `verify` | strips as a GPU draws them, and what they must draw |
//! | `stripify` | the public function: start here |
//! | `dual_node`, `dual`, `order` | faces as nodes of the dual graph, neighbours close in memory |
//! | `path_cover`, `greedy` | strips as paths: the first cover |
//! | `energy`, `region`, `tunnel`, `anneal`, `touched`, `random` | the cover improved move by move |
//! | `cache_runs`, `emit`, `parity` | paths cut for a vertex cache and made sequences |
//! | `skip`, `filter` | one set of strips for all levels |
//! | `repair`, `selective` | strips that follow levels and cuts |
//! | `measure`, `overdraw` | what strips cost |

#![forbid(unsafe_code)]

mod anneal;
mod cache_runs;
mod dual;
mod dual_node;
mod emit;
mod energy;
mod filter;
mod greedy;
mod measure;
mod order;
mod overdraw;
mod parity;
mod path_cover;
mod random;
mod region;
mod repair;
mod selective;
mod sequence;
mod skip;
mod stripify;
mod strips;
mod touched;
mod tunnel;
mod verify;

pub use cache_runs::CacheAware;
pub use energy::Prices;
pub use filter::Filter;
pub use measure::{StripStatistics, acmr};
pub use overdraw::overdraw;
pub use repair::{LevelStrips, LiveStrips, StripEffort, StripIndices};
pub use selective::CutStrips;
pub use skip::{HistoryError, MergeTree, SkipStrip, StripWedge};
pub use stripify::{StripOptions, StripQuality, stripify};
pub use strips::Strips;
pub use verify::{Difference, difference};
