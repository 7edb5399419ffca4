//! Scenes in files of one mesh, multiresolution or compressed: the meshes merged, all else as
//! resources.
//!
//! [`place_scene`] puts each mesh of a scene into one mesh in world space, once, and packs the rest:
//! nodes, materials, skins, animations and images. Of that mesh the levels are made, or it is
//! compressed. [`ModelScene`] takes a level, or the decoded mesh, apart again. docs/formats/mlod.md
//! specifies the bytes.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `place`, `placement`, `slots`, `split`, `selector` | a scene on its way in |
//! | `head`, `resources`, `parts`, `image_versions`, `weights` | what is stored of it |
//! | `restore`, `take_back`, `layout` | a scene on its way out |
//! | `instance_query`, `counts`, `limits` | questions about it |

mod counts;
mod head;
mod image_versions;
mod instance_query;
mod layout;
mod limits;
mod parts;
mod place;
mod placement;
mod resources;
mod restore;
mod selector;
mod slots;
mod split;
mod take_back;
#[cfg(test)]
mod tests;
mod weights;

pub use counts::SceneCounts;
pub use instance_query::SceneQueryError;
pub use layout::{LevelInstance, SceneLayout};
pub use limits::model_limits;
pub use place::{PackedScene, PlaceError, PlacedScene, place_scene};
pub use restore::{MissingParts, ModelScene, ModelSceneError, measured_poses};
