//! Scenes inside `.mlod`, `.mlq` and `.mlz` files, and what is known of their levels.
//!
//! [`place_scene`] merges a scene into one mesh, each of its meshes once, and packs the rest;
//! [`ModelScene`] takes a level of that mesh apart again. [`ScenePoses`] has the poses in which
//! errors are measured, and a [`Verification`] says what is proved of an extracted level. Parts of
//! this module may still change.

pub(crate) mod cut_volume;
mod posed;
pub(crate) mod scene;
pub(crate) mod verified;

pub use posed::{PoseCounts, ScenePoses, posed_mesh};
pub use scene::{
    LevelInstance, MissingParts, ModelScene, ModelSceneError, PackedScene, PlaceError, PlacedScene,
    SceneCounts, SceneLayout, SceneQueryError, measured_poses, model_limits, place_scene,
};
pub use verified::Verification;
