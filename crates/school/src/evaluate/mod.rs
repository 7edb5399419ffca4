//! Evaluation of policies: triangles against image error, at equal terms.
//!
//! [`Footage`](crate::Footage) is a recorded flock seen by a camera. Every [`Arm`] chooses levels
//! for the same frames; its one bias is set so that it draws a given share of the triangles of full
//! detail. All arms are drawn by the same rasteriser with the same supersampling, and compared with
//! full detail on the pixels that show the flock. The scores of an arm over all shares make a
//! curve, from which the triangles needed for an image error are read.
//!
//! To read: `run`, the loop; `arms` with their `controls`; `scene_references`, a scene and its
//! frames in full detail; `chosen_levels`, one arm with one bias; `score`, a frame; `curve`,
//! `bootstrap` and `evaluation`, the figures; `over_time`, the paper's experiment.

mod arms;
mod bootstrap;
mod chosen_levels;
mod controls;
mod curve;
mod evaluation;
mod over_time;
mod run;
mod scene_references;
mod score;

pub use arms::Arm;
pub use bootstrap::Interval;
pub use curve::{Needed, Row, triangles_for};
pub use evaluation::Evaluation;
pub use over_time::{Track, over_time};
pub use run::{EvaluationOptions, evaluate};
pub use scene_references::StillPicture;
pub use score::{FrameScore, Reference};
