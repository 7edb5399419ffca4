//! Sets of kinds of findings, to choose what a mesh is checked for.

use crate::finding::{Kind, Severity};

/// A set of kinds of findings, to choose what a mesh is checked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Kinds(u16);

impl Kinds {
    /// The set of all kinds of findings.
    pub const ALL: Self = Self((1 << Kind::ALL.len()) - 1);
    /// The empty set of kinds of findings.
    pub const NONE: Self = Self(0);

    /// Returns the set of the kinds of findings that are errors, not warnings.
    pub fn errors() -> Self {
        Kind::ALL.into_iter().filter(|kind| kind.severity() == Severity::Error).collect()
    }

    /// Returns the set with a kind of finding added.
    #[must_use]
    pub fn with(self, kind: Kind) -> Self {
        Self(self.0 | Self::bit(kind))
    }

    /// Returns the set with a kind of finding removed.
    #[must_use]
    pub fn without(self, kind: Kind) -> Self {
        Self(self.0 & !Self::bit(kind))
    }

    /// Returns true if the set contains this kind of finding.
    pub fn contains(self, kind: Kind) -> bool {
        self.0 & Self::bit(kind) != 0
    }

    /// Returns true if the set contains at least one of these kinds of findings.
    pub fn any_of(self, kinds: &[Kind]) -> bool {
        kinds.iter().any(|&kind| self.contains(kind))
    }

    fn bit(kind: Kind) -> u16 {
        1 << kind as u16
    }
}

/// Writes the kinds as a list of names, and all kinds as `"all"`, so that kinds added later belong
/// to them.
#[cfg(feature = "serde")]
impl serde::Serialize for Kinds {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if *self == Self::ALL && serializer.is_human_readable() {
            return serializer.serialize_str(ALL);
        }
        serializer.collect_seq(Kind::ALL.into_iter().filter(|&kind| self.contains(kind)))
    }
}

/// Reads a list of the names of kinds, or `"all"`.
#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Kinds {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        if deserializer.is_human_readable() {
            deserializer.deserialize_any(KindsVisitor)
        } else {
            deserializer.deserialize_seq(KindsVisitor)
        }
    }
}

/// Name of [`Kinds::ALL`] in files that people read.
#[cfg(feature = "serde")]
const ALL: &str = "all";

#[cfg(feature = "serde")]
struct KindsVisitor;

#[cfg(feature = "serde")]
impl<'de> serde::de::Visitor<'de> for KindsVisitor {
    type Value = Kinds;

    fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "a list of kinds of findings, or \"{ALL}\"")
    }

    fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<Kinds, E> {
        if name == ALL {
            Ok(Kinds::ALL)
        } else {
            Err(E::invalid_value(serde::de::Unexpected::Str(name), &self))
        }
    }

    fn visit_seq<A: serde::de::SeqAccess<'de>>(self, mut kinds: A) -> Result<Kinds, A::Error> {
        let mut set = Kinds::NONE;
        while let Some(kind) = kinds.next_element()? {
            set = set.with(kind);
        }
        Ok(set)
    }
}

impl Default for Kinds {
    fn default() -> Self {
        Self::ALL
    }
}

impl FromIterator<Kind> for Kinds {
    fn from_iter<I: IntoIterator<Item = Kind>>(kinds: I) -> Self {
        kinds.into_iter().fold(Self::NONE, Self::with)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_are_all_and_each_can_be_left_out() {
        assert_eq!(Kind::ALL.into_iter().collect::<Kinds>(), Kinds::ALL);
        for kind in Kind::ALL {
            let others = Kinds::ALL.without(kind);
            assert!(!others.contains(kind) && others.with(kind) == Kinds::ALL);
        }
    }

    #[test]
    fn errors_are_what_severity_says() {
        assert!(Kinds::errors().contains(Kind::NonManifoldEdge));
        assert!(!Kinds::errors().any_of(&[Kind::BoundaryLoop, Kind::Contact]));
    }
}
