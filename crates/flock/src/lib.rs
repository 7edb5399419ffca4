//! Flocks of instanced meshes: levels of their model, policies that choose one for every member,
//! and drawing.
//!
//! A [`Flock`] has the positions and headings of its [`Members`], wherever they come from;
//! [`levels`] prepares the levels of the model, [`select`] chooses a level for each member as a
//! [`FlockCamera`] sees it, [`nearest`] refines the nearest ones by cuts that follow the view, and
//! [`draw`] makes pictures of a frame.
#![forbid(unsafe_code)]

mod camera;
mod cell_index;
pub mod draw;
mod flock;
pub mod levels;
mod members;
pub mod nearest;
pub mod select;

pub use camera::{CameraError, FlockCamera};
pub use flock::{Flock, School};
pub use members::{Members, frame_of};
