//! The formats and their suffixes.

use std::path::Path;

use crate::IoError;

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Stanford polygon file, ascii or binary.
    Ply,
    /// Wavefront object with its material library.
    Obj,
    /// Stereolithography, ascii or binary.
    Stl,
    /// Object file format, with COFF and NOFF.
    Off,
    /// Simple model format of Garland's QSlim.
    Smf,
    /// glTF 2.0 as JSON, with its buffers beside or in it.
    Gltf,
    /// glTF 2.0 in one binary file.
    Glb,
}

impl Format {
    /// Every format with its suffix.
    pub const ALL: [(&str, Self); 7] = [
        ("ply", Self::Ply),
        ("obj", Self::Obj),
        ("stl", Self::Stl),
        ("off", Self::Off),
        ("smf", Self::Smf),
        ("gltf", Self::Gltf),
        ("glb", Self::Glb),
    ];

    /// The format that goes with a suffix (`ply`, `GLB`), whatever its case.
    pub fn of_suffix(suffix: &str) -> Option<Self> {
        let found = Self::ALL.iter().find(|(known, _)| known.eq_ignore_ascii_case(suffix));
        found.map(|&(_, format)| format)
    }

    /// The format that the suffix of a path names.
    ///
    /// # Errors
    /// [`IoError::UnknownFormat`] when there is no suffix, or an unknown one.
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
