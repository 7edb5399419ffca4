//! Cuts of a multiresolution model on the GPU: index buffers are patched where the cut changes.
//!
//! In the order of reading:
//! - the levels as they are drawn: `model`, with its `groups` of triangles, the `places` where a
//!   scene shows them (`gpu_place` for shaders), its `materials`, and the `fields` of its vertices;
//! - a thread that follows queries: `query` (queries and steps, with `error`), `follower` in front
//!   of the thread, `worker` on it, `followed` (the cut that it changes), and `slots` (changes by
//!   group);
//! - the buffers that are changed: `gpu_cut`, a `list` of triangles for each group, its `dirty`
//!   ranges, the bytes `staged` for them, vertices sent by `scatter`, and triangles that `fade`;
//! - `pipelines`.

mod dirty;
mod error;
mod fade;
mod fields;
mod followed;
mod follower;
mod gpu_cut;
mod gpu_place;
mod groups;
mod list;
mod materials;
mod model;
mod pipelines;
mod places;
mod query;
mod scatter;
mod slots;
mod staged;
mod worker;

pub use self::error::CutError;
pub use self::fields::MovedVertex;
pub use self::follower::CutFollower;
pub use self::gpu_cut::{GpuCut, Transition};
pub use self::model::CutModel;
pub use self::query::{CutQuery, CutStep, CutTolerance, FollowOptions};
pub use self::slots::CutPatch;
