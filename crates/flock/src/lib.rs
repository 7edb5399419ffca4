//! Flocks of instanced meshes: a simulation, policies that choose a level for every member, and the
//! evaluation of what they cost and show.
#![forbid(unsafe_code)]

mod camera;
mod cell_index;
pub mod draw;
pub mod evaluate;
mod flock;
pub mod levels;
mod members;
pub mod nearest;
pub mod recording;
pub mod scene;
pub mod select;
pub mod simulation;

pub use camera::{CameraError, FlockCamera};
pub use flock::{Flock, School};
pub use members::{Members, frame_of};
