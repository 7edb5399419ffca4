//! Contents of a PLY file beyond its mesh, kept for writing the scene as PLY.

use std::collections::BTreeMap;

use super::scalar::Scalar;

/// Contents specific to PLY, kept for writing the scene as PLY again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlyExtras {
    /// Lines `comment` and `obj_info` of the header, without those that name textures.
    pub remarks: Vec<String>,
    /// Types of properties that differ from the default types, by name; face properties have the
    /// prefix `face`.
    pub(super) types: BTreeMap<String, Scalar>,
}

impl PlyExtras {
    /// Returns the type of a property in the file, or `usual` if it is unknown.
    pub(super) fn kind(&self, name: &str, usual: Scalar) -> Scalar {
        self.types.get(name).copied().unwrap_or(usual)
    }
}
