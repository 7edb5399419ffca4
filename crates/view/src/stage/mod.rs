//! Model of the viewer, without a window: loaded files, subjects on the GPU, their display and the
//! camera. Scripts without a window use it as the viewer does.
//!
//! A file is [`Loaded`] on any thread and uploaded as a [`Subject`] on any thread; a [`Stage`]
//! shows subjects in slots side by side, all seen by one [`CameraRig`] and in one [`Display`].

mod compressed;
mod display;
mod levels;
mod loaded;
mod palette;
mod pose;
mod rig;
mod scene;
mod subject;

pub use compressed::CompressedSubject;
pub use display::{Coloring, Display, Shading};
pub use levels::LevelsSubject;
pub use loaded::{LoadError, Loaded, LoadedContent};
pub use pose::{RigPose, Side};
pub use rig::CameraRig;
pub use scene::{Stage, SubjectId};
pub use subject::{MeshSubject, Subject};
