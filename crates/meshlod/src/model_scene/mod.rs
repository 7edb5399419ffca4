//! Scenes in multiresolution files: their meshes as levels, all else as resources.
//!
//! [`place_scene`] puts each mesh of a scene into one mesh in world space, once, of which the levels
//! are made, and packs the rest: nodes, materials, skins, animations, and images from small to large.
//! [`ModelScene`] takes a level apart again. docs/formats/mlod.md specifies the bytes.

mod head;
mod image_versions;
mod parts;
mod place;
mod placement;
mod restore;
mod split;
#[cfg(test)]
mod tests;

pub use place::{PackedScene, PlaceError, PlacedScene, SceneCounts, place_scene};
pub use restore::{MissingParts, ModelScene, ModelSceneError};
