//! Scenes: simplified under one target, constrained, fused, repaired, painted.
//!
//! [`jobs`](crate::jobs) do all of this in one call; here are its parts, for programs that go
//! through a scene step by step. Parts of this module may still change.
//!
//! A [`ConditionedScene`] is ready to be simplified, and a [`SceneSimplifier`] shares a target among
//! its meshes. [`Constraints`] say what must stay. [`materials_of`] and [`OwnedPaint`] have what a
//! picture of a scene needs.

#[cfg(feature = "picture")]
mod appearance;
mod conditioned_scene;
#[cfg(feature = "check")]
mod constraints;
#[cfg(feature = "check")]
mod contacts;
mod exact_volume;
#[cfg(feature = "check")]
mod fuse;
pub(crate) mod locks;
#[cfg(feature = "picture")]
mod materials;
pub(crate) mod place;
mod simplifier;
mod sizes;

pub use crate::conditioned::FlatFaces;
#[cfg(feature = "picture")]
pub use appearance::{OwnedPaint, normals_of};
pub use conditioned_scene::ConditionedScene;
#[cfg(feature = "check")]
pub use constraints::{Constraints, VertexLocking};
#[cfg(feature = "check")]
pub use contacts::scene_locks;
pub use exact_volume::{closed_volume, closed_volume_of_distinct, conserve_volumes, digits_of};
#[cfg(feature = "check")]
pub use fuse::{FuseReport, fuse_scene};
pub use locks::join_locks;
#[cfg(feature = "picture")]
pub use materials::{ImageWarning, materials_of, single_sided_materials};
#[cfg(feature = "check")]
pub(crate) use place::rounding_in_meshes;
pub use place::{moved_at_most, rounding_of_level, shown_rounding, world_bounds};
pub use simplifier::{SceneError, SceneSimplifier};
pub use sizes::{ShownSizes, shown_sizes};
