//! Flocks of instanced meshes: a simulation, policies that choose a level for every member, and the
//! evaluation of what they cost and show.
#![forbid(unsafe_code)]

mod camera;
pub mod draw;
pub mod evaluate;
mod flock;
pub mod levels;
mod members;
pub mod nearest;
pub mod scene;
pub mod select;
pub mod simulation;

pub use camera::{Camera, CameraError};
pub use flock::{Flock, School};
pub use members::{Members, frame_of};
