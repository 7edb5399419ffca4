//! Errors of the simulation.

use meshlod::spatial::BvhError;
use thiserror::Error;

/// Reason why a simulation cannot be made or advanced.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SimulationError {
    /// An option is outside its range, or not a number.
    #[error("{option} must be {range}, not {value}")]
    Option {
        /// Name of the option.
        option: &'static str,
        /// Range that the option must be in.
        range: &'static str,
        /// Value of the option.
        value: f32,
    },
    /// An option of a school is outside its range, or not a number.
    #[error("school {school}: {option} must be {range}, not {value}")]
    School {
        /// Index of the school.
        school: usize,
        /// Name of the option.
        option: &'static str,
        /// Range that the option must be in.
        range: &'static str,
        /// Value of the option.
        value: f32,
    },
    /// An obstacle has a coordinate or radius outside its range, or not a number.
    #[error("obstacle {0}: coordinates must be within 1e6 of the origin, and the radius over 0")]
    Obstacle(usize),
    /// No obstacle has this index.
    #[error("the simulation has {count} obstacles, counted from 0; there is no obstacle {index}")]
    NoObstacle {
        /// Requested index.
        index: usize,
        /// Number of obstacles.
        count: usize,
    },
    /// A step is so long that a member could pass through an obstacle.
    #[error(
        "a member at {max_speed} body lengths per second swims farther than its clearance of \
         {clearance} in a step of {step_s} s: shorten the step"
    )]
    StepTooLong {
        /// Length of the step in seconds.
        step_s: f32,
        /// Greatest speed of a member.
        max_speed: f32,
        /// Distance that members keep from obstacles.
        clearance: f32,
    },
    /// There are more members than 32 bits can count.
    #[error("a simulation can have 4294967295 members, not {0}")]
    TooManyMembers(usize),
    /// The time to advance by is negative, not a number, or more than an hour.
    #[error("the time to advance by must be between 0 and 3600 s, not {0}")]
    Time(f64),
}

/// Reason why a leader's path cannot be made.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum PathError {
    /// A closed path needs at least three waypoints.
    #[error("a closed path needs at least three waypoints, not {0}")]
    TooFew(usize),
    /// A waypoint is not finite or farther than 1e6 body lengths from the origin.
    #[error("waypoint {0} must be finite and within 1e6 of the origin")]
    NotFinite(usize),
    /// A waypoint is where the one before it is.
    #[error("waypoint {0} is where the one before it is: leave one out")]
    Repeated(usize),
}

/// Reason why no distance field can be made of a mesh.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum FieldError {
    /// The mesh has no faces, or is invalid.
    #[error(transparent)]
    Mesh(#[from] BvhError),
    /// All faces of the mesh are degenerate, so that it has no sides.
    #[error("every face of the mesh has no area, so that none has a side")]
    NoArea,
    /// A vertex is too far away for single precision.
    #[error("the mesh must be within 1e6 body lengths of the origin")]
    TooFar,
    /// The number of samples along the longest side is out of range.
    #[error("the resolution must be between 2 and 256 cells, not {0}")]
    Resolution(u32),
}
