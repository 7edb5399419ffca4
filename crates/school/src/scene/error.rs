//! Errors of scenarios.

use meshlod::flock::CameraError;
use thiserror::Error;

use crate::simulation::{FieldError, PathError, SimulationError};

/// Reason why a scenario cannot be set up or filmed.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SceneError {
    /// There are no members.
    #[error("a flock needs at least one member")]
    NoMembers,
    /// The number of schools is zero, more than there are members, or too large.
    #[error("{members} members can form 1 to {most} schools, not {schools}")]
    Schools {
        /// Requested number of schools.
        schools: usize,
        /// Number of members.
        members: usize,
        /// Greatest number of schools.
        most: usize,
    },
    /// The time from frame to frame is out of range.
    #[error("the time from frame to frame must be between 0.0001 and 60 s, not {0}")]
    FrameTime(f64),
    /// The scenario needs a terrain, but none is given.
    #[error("the scenario `terrain` needs a terrain to swim over")]
    NoTerrain,
    /// The terrain has no faces, is not finite, or has no extent along x or z.
    #[error("the terrain must have faces, and an extent along x and z")]
    FlatTerrain,
    /// An obstacle cannot be made.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The path of a leader cannot be made.
    #[error(transparent)]
    Path(#[from] PathError),
    /// The simulation refuses an option.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The camera cannot be made.
    #[error(transparent)]
    Camera(#[from] CameraError),
}
