//! Levels of a model for its thousands of instances: chains, their cost and their image errors.
//!
//! A [`LevelTable`] holds all levels of one model in one vertex and one index buffer, so that a
//! renderer binds them once and draws every level as a range of indices. Its chains are
//! - the **whole** chain, coarsened evenly;
//! - the **left-coarsened** and **right-coarsened** chains, whose other side stays fine;
//! - **facing** chains, one for each direction from which a member may be seen: levels of the whole
//!   chain without the faces that no eye in that direction can see.
//!
//! At the far end a member can be an [`Impostor`]: one quad with a picture of the model.
//!
//! For every level and direction the table knows how much a picture changes, at several sizes.

mod build;
mod difference;
mod directions;
mod facing;
mod impostor;
mod look;
mod model;
mod normals;
mod pool;
mod table;

pub use build::ChainOptions;
pub use difference::Differences;
pub use directions::DirectionGrid;
pub use facing::NEAREST_FACING;
pub use impostor::{Impostor, ImpostorOptions, ImpostorQuad};
pub use look::Look;
pub(crate) use look::is_color;
pub use model::{ModelAxes, in_member_frame};
pub use table::{Chain, ChainKind, FacingLevels, Level, LevelTable, TableError};
