//! Levels of a model for its thousands of instances: chains, and what they cost and show.
//!
//! A [`LevelTable`] holds all levels of one model in one vertex and one index buffer, so that a
//! renderer binds them once and draws every level as a range of indices. Its chains are
//! - the **whole** chain, coarsened evenly;
//! - the **left-coarsened** and **right-coarsened** chains, whose other side stays fine;
//! - **facing** chains, one for each direction from which a member may be seen: levels of the whole
//!   chain without the faces that no eye in that direction can see.
//!
//! For every level and direction the table knows how much a picture changes, at several sizes.

mod build;
mod difference;
mod directions;
mod facing;
mod model;
mod normals;
mod pool;
mod table;

pub use build::{ChainOptions, Look};
pub use difference::Differences;
pub use directions::DirectionGrid;
pub use facing::NEAREST_FACING;
pub use model::ModelAxes;
pub use table::{Chain, ChainKind, FacingLevels, Level, LevelTable, TableError};
