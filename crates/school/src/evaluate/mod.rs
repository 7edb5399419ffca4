//! Evaluation of policies: triangles against image error, at equal terms.
//!
//! [`Footage`](crate::Footage) is a recorded flock seen by a camera. Every [`Arm`] chooses levels for the same
//! frames; its one bias is set so that it draws a given share of the triangles of full detail. All
//! arms are drawn by the same rasteriser with the same supersampling, and compared with full detail
//! on the pixels that show the flock. The scores of an arm over all shares make a curve, on which
//! the triangles needed for an image error are found.

mod arms;
mod bootstrap;
mod controls;
mod curve;
mod over_time;
mod run;
mod score;

pub use arms::Arm;
pub use bootstrap::Interval;
pub use curve::{Needed, Row, triangles_for};
pub use over_time::{Track, over_time};
pub use run::{Evaluation, EvaluationOptions, StillPicture, evaluate};
pub use score::{FrameScore, Reference};
