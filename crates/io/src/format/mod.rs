//! Supported mesh file formats: their suffixes and the facts about them.
//!
//! `table` has a row for each format, `facts` the meaning of its columns.

pub(crate) mod facts;
pub(crate) mod table;

use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::sync::LazyLock;

use meshlod_mesh::UnknownName;

use crate::error::{IoError, Unsupported};
use crate::precision::Precision;
pub use facts::StoredDigits;
use facts::{Coordinates, FormatFacts, Holds, Stores, VertexSharing};
pub use table::Format;
use table::{READ_ALONE, TABLE};

/// Suffixes of all formats, each with its dot, separated by spaces.
static SUFFIXES: LazyLock<String> = LazyLock::new(|| {
    let suffixes = TABLE.iter().flat_map(|row| row.suffixes);
    suffixes.map(|suffix| format!(".{suffix}")).collect::<Vec<_>>().join(" ")
});

impl Format {
    /// All supported formats, each with its file name suffix.
    pub const ALL: [(&str, Self); TABLE.len()] = {
        let mut all = [("", Self::Ply); TABLE.len()];
        let mut i = 0;
        while i < TABLE.len() {
            assert!(TABLE[i].format as usize == i, "the table has the order of the formats");
            all[i] = (TABLE[i].suffixes[0], TABLE[i].format);
            i += 1;
        }
        all
    };

    /// Returns the format with a file name suffix such as `ply` or `GLB`, ignoring case.
    pub fn of_suffix(suffix: &str) -> Option<Self> {
        let is_known = |known: &&str| known.eq_ignore_ascii_case(suffix);
        TABLE.iter().find(|row| row.suffixes.iter().any(is_known)).map(|row| row.format)
    }

    /// Returns the format of a file, determined by the suffix of its path.
    ///
    /// # Errors
    /// [`IoError::UnknownFormat`] if the suffix is missing or unknown.
    pub fn of_path(path: &Path) -> Result<Self, IoError> {
        let suffix = path.extension().and_then(|suffix| suffix.to_str());
        suffix.and_then(Self::of_suffix).ok_or_else(|| IoError::UnknownFormat {
            path: path.to_owned(),
            known: Self::suffixes(),
        })
    }

    /// Returns the format of a file to be written, determined by the suffix of its path.
    ///
    /// # Errors
    /// Those of [`of_path`](Self::of_path); also suffixes of files that are only read, such as b3dm.
    pub fn of_output(path: &Path) -> Result<Self, IoError> {
        let format = Self::of_path(path)?;
        if path.extension().and_then(|suffix| suffix.to_str()).is_some_and(Self::is_read_only) {
            let reason = "b3dm is read only; write .glb, which 3D Tiles 1.1 holds as it is";
            return Err(IoError::unsupported(path, Unsupported::new("file", reason)));
        }
        Ok(format)
    }

    /// Returns true for a suffix of files that are read, but not written, such as b3dm.
    pub fn is_read_only(suffix: &str) -> bool {
        suffix.eq_ignore_ascii_case(READ_ALONE)
    }

    /// Returns the suffixes of all formats, as in `.ply .obj`.
    pub fn suffixes() -> &'static str {
        &SUFFIXES
    }

    /// Returns true for glTF, as `.gltf` or `.glb`.
    pub fn is_gltf(self) -> bool {
        self.stores().holds == Holds::Document
    }

    /// Returns true if the reader welds vertices that the format splits, see
    /// [`Weld::Exact`](crate::Weld::Exact).
    pub fn is_welded(self) -> bool {
        self.stores().vertices != VertexSharing::Indexed
    }

    /// Returns the number format of coordinates, for scenes that are not several STL solids;
    /// [`Precision::Auto`] counts as 32 bits.
    pub fn stored_digits(self, precision: Precision) -> StoredDigits {
        match (self.stores().coordinates, precision) {
            (Coordinates::Binary32, _) => StoredDigits::F32,
            (_, Precision::F64) => StoredDigits::F64,
            (Coordinates::Binary, _) => StoredDigits::F32,
            (Coordinates::Decimal, _) => StoredDigits::Decimal,
        }
    }

    pub(crate) fn stores(self) -> &'static Stores {
        &self.facts().stores
    }

    pub(crate) fn facts(self) -> &'static FormatFacts {
        &TABLE[self as usize]
    }
}

/// Prints the suffix of the format.
impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.facts().suffixes[0])
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
    fn a_tile_is_read_and_not_written() {
        let path = Path::new("tile.B3dm");
        assert_eq!(Format::of_path(path).unwrap(), Format::Glb);
        let message = Format::of_output(path).unwrap_err().to_string();
        assert!(message.contains("write .glb"), "{message}");
    }

    #[test]
    fn an_unknown_suffix_is_answered_by_the_known_ones() {
        for path in ["bunny", "bunny.fbx", ".ply"] {
            let message = Format::of_path(Path::new(path)).unwrap_err().to_string();
            assert!(Format::ALL.iter().all(|(suffix, _)| message.contains(suffix)), "{message}");
            assert!(message.contains(".gltf .glb .vrm .b3dm"), "{message}");
        }
    }
}
