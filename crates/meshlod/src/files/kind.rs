//! Kinds of files by their suffixes.

use std::path::Path;

use meshlod_io::{Format, IoError};

/// Kind of a file that we read or write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A mesh or scene in a format that other programs read, too.
    Mesh(Format),
    /// All levels of a mesh or scene, `.mlod`.
    Levels,
    /// A compressed mesh or scene to draw from directly, `.mlq`.
    Resident,
    /// A compressed mesh or scene to send, `.mlz`.
    Sent,
}

impl FileKind {
    /// Kinds of our own with their suffixes.
    pub const OWN: [(&str, Self); 3] =
        [("mlod", Self::Levels), ("mlq", Self::Resident), ("mlz", Self::Sent)];

    /// Returns the kind of a file by the suffix of its path, in any case.
    ///
    /// # Errors
    /// [`IoError::UnknownFormat`] if the suffix is missing or unknown.
    pub fn of_path(path: &Path) -> Result<Self, IoError> {
        match Self::own_of_path(path) {
            Some(own) => Ok(own),
            None => Format::of_path(path).map(Self::Mesh),
        }
    }

    /// Returns the kind of a file with a suffix of our own; `None` for those of other programs.
    pub fn own_of_path(path: &Path) -> Option<Self> {
        let suffix = path.extension()?.to_str()?;
        let found = Self::OWN.iter().find(|(own, _)| suffix.eq_ignore_ascii_case(own));
        found.map(|&(_, kind)| kind)
    }

    /// Returns the format of other programs that a file of this kind has.
    pub fn format(self) -> Option<Format> {
        match self {
            Self::Mesh(format) => Some(format),
            Self::Levels | Self::Resident | Self::Sent => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_suffix_has_one_kind() {
        let kind = |name: &str| FileKind::of_path(Path::new(name)).unwrap();
        assert_eq!(kind("a.MLOD"), FileKind::Levels);
        assert_eq!(kind("a.glb.mlz"), FileKind::Sent);
        assert_eq!(kind("a.mlz.glb"), FileKind::Mesh(Format::Glb));
        for name in ["mlod", ".mlod", "a.png", ""] {
            assert!(FileKind::of_path(Path::new(name)).is_err(), "{name}");
        }
    }
}
