//! Scenes in multiresolution files: their meshes as levels, all else as resources.
//!
//! [`place_scene`] puts each mesh of a scene into one mesh in world space, once, of which the levels
//! are made, and packs the rest: nodes, materials, skins, animations, and images from small to large.
//! [`ModelScene`] takes a level apart again. docs/formats/mlod.md specifies the bytes.

mod counts;
mod head;
mod image_versions;
mod parts;
mod place;
mod placement;
mod restore;
mod selector;
mod slots;
mod split;
#[cfg(test)]
mod tests;
mod weights;

pub use counts::SceneCounts;
pub use place::{PackedScene, PlaceError, PlacedScene, place_scene};
pub use restore::{MissingParts, ModelScene, ModelSceneError};
