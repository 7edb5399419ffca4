//! Supported file formats and their suffixes.

use std::path::Path;

use crate::IoError;

/// Mesh file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Stanford polygon file (PLY), text or binary.
    Ply,
    /// Wavefront OBJ with its material library.
    Obj,
    /// Stereolithography file (STL), text or binary.
    Stl,
    /// Object File Format (OFF), including its COFF and NOFF variants.
    Off,
    /// Simple Model Format (SMF) of Garland's QSlim.
    Smf,
    /// glTF 2.0 as JSON, with buffers in separate files or embedded.
    Gltf,
    /// glTF 2.0 in a single binary file.
    Glb,
}

impl Format {
    /// All formats with their suffixes.
    pub const ALL: [(&str, Self); 7] = [
        ("ply", Self::Ply),
        ("obj", Self::Obj),
        ("stl", Self::Stl),
        ("off", Self::Off),
        ("smf", Self::Smf),
        ("gltf", Self::Gltf),
        ("glb", Self::Glb),
    ];

    /// Returns the format of a suffix such as `ply` or `GLB`, ignoring case.
    pub fn of_suffix(suffix: &str) -> Option<Self> {
        let found = Self::ALL.iter().find(|(known, _)| known.eq_ignore_ascii_case(suffix));
        found.map(|&(_, format)| format)
    }

    /// Returns the format that the suffix of a path names.
    ///
    /// # Errors
    /// [`IoError::UnknownFormat`] if the suffix is missing or unknown.
    pub fn of_path(path: &Path) -> Result<Self, IoError> {
        let suffix = path.extension().and_then(|suffix| suffix.to_str());
        suffix.and_then(Self::of_suffix).ok_or_else(|| IoError::UnknownFormat {
            path: path.to_owned(),
            known: ".ply .obj .stl .off .smf .gltf .glb",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_suffix_decides_in_any_case() {
        assert_eq!(Format::of_path(Path::new("a.ply/b.GLB")).unwrap(), Format::Glb);
    }

    #[test]
    fn an_unknown_suffix_is_told_the_known_ones() {
        for path in ["bunny", "bunny.fbx", ".ply"] {
            let message = Format::of_path(Path::new(path)).unwrap_err().to_string();
            assert!(Format::ALL.iter().all(|(suffix, _)| message.contains(suffix)), "{message}");
        }
    }
}
