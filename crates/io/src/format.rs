//! Supported mesh file formats and their suffixes.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use meshlod_mesh::UnknownName;
use serde::{Deserialize, Serialize};

use crate::IoError;

/// File format of a mesh or scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Polygon File Format (PLY, the Stanford format), text or binary.
    Ply,
    /// Wavefront OBJ with its material library (MTL).
    Obj,
    /// STL, the format of stereolithography: triangles without shared vertices, text or binary.
    Stl,
    /// Object File Format (OFF), including its COFF and NOFF variants.
    Off,
    /// Simple Model Format (SMF), the text format of Garland's QSlim.
    Smf,
    /// glTF 2.0 as a JSON file, with buffers embedded or in separate files.
    Gltf,
    /// glTF 2.0 as a single binary file, `.glb` or `.vrm`.
    Glb,
}

impl Format {
    /// All supported formats, each with its file name suffix.
    pub const ALL: [(&str, Self); 7] = [
        ("ply", Self::Ply),
        ("obj", Self::Obj),
        ("stl", Self::Stl),
        ("off", Self::Off),
        ("smf", Self::Smf),
        ("gltf", Self::Gltf),
        ("glb", Self::Glb),
    ];

    /// Returns the format with a file name suffix such as `ply` or `GLB`, ignoring case.
    pub fn of_suffix(suffix: &str) -> Option<Self> {
        let found = Self::ALL.iter().find(|(known, _)| known.eq_ignore_ascii_case(suffix));
        // VRM files, avatars of people, are GLB files with extensions of their own.
        let vrm = suffix.eq_ignore_ascii_case("vrm").then_some(Self::Glb);
        found.map(|&(_, format)| format).or(vrm)
    }

    /// Returns the format of a file, determined by the suffix of its path.
    ///
    /// # Errors
    /// [`IoError::UnknownFormat`] if the suffix is missing or unknown.
    pub fn of_path(path: &Path) -> Result<Self, IoError> {
        let suffix = path.extension().and_then(|suffix| suffix.to_str());
        suffix.and_then(Self::of_suffix).ok_or_else(|| IoError::UnknownFormat {
            path: path.to_owned(),
            known: ".ply .obj .stl .off .smf .gltf .glb .vrm",
        })
    }
}

/// Prints the suffix of the format.
impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = Self::ALL.iter().find(|(_, format)| format == self);
        f.pad(named.map_or("", |(suffix, _)| suffix))
    }
}

/// Parses a suffix such as `ply`, in any case.
impl FromStr for Format {
    type Err = UnknownName;

    fn from_str(suffix: &str) -> Result<Self, UnknownName> {
        Self::of_suffix(suffix).ok_or_else(|| UnknownName {
            name: suffix.to_owned(),
            nouns: "formats",
            known: Self::ALL.map(|(known, _)| known).to_vec(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_suffix_decides_in_any_case() {
        assert_eq!(Format::of_path(Path::new("a.ply/b.GLB")).unwrap(), Format::Glb);
        assert_eq!(Format::of_path(Path::new("avatar.Vrm")).unwrap(), Format::Glb);
    }

    #[test]
    fn an_unknown_suffix_is_told_the_known_ones() {
        for path in ["bunny", "bunny.fbx", ".ply"] {
            let message = Format::of_path(Path::new(path)).unwrap_err().to_string();
            assert!(Format::ALL.iter().all(|(suffix, _)| message.contains(suffix)), "{message}");
        }
    }
}
