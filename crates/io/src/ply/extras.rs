//! Contents of a PLY file beyond its mesh, for a file written from the scene.

use std::collections::BTreeMap;

use super::scalar::Scalar;

/// Contents of a PLY file that no other format has, kept for writing the scene as PLY again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyExtras {
    /// Lines `comment` and `obj_info` of the header, without those that name textures.
    pub remarks: Vec<String>,
    /// Types of the properties that are not written as the usual ones, by name; the names of those
    /// of faces follow the word `face`.
    pub(super) types: BTreeMap<String, Scalar>,
}

impl PlyExtras {
    /// Returns the type of a property, or `usual` if the file did not say.
    pub(super) fn kind(&self, name: &str, usual: Scalar) -> Scalar {
        self.types.get(name).copied().unwrap_or(usual)
    }
}
