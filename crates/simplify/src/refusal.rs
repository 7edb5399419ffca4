//! Reasons why contractions are refused, and their counts.

use std::fmt;
use std::ops::AddAssign;

/// Reason why the contraction of an edge or face is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Refusal {
    /// An edge with three or more faces would be contracted.
    NonManifold,
    /// Two boundaries would be joined across the surface, or a vertex would move off its boundary.
    Boundary,
    /// The two ends have a common neighbour besides the apexes of the edge's faces, so that the
    /// link condition fails [DEGN99].
    Link,
    /// A face would flip, or lose its area.
    Flip,
    /// At least two of the vertices to be merged are locked.
    Locked,
    /// The vertices tied to those to be merged cannot move along with them.
    Tied,
    /// A texture chart would be lost, because the contraction does not follow the seam.
    Seam,
    /// The last faces of a connected component would be removed.
    LastFaces,
    /// Too many faces meet at the vertices to be merged.
    Valence,
    /// No suitable position of the new vertex conserves the volume or, in `qem`, minimizes the
    /// cost.
    Volume,
    /// The error would exceed the target.
    Error,
    /// The surface would move by a large part of the model's size, and much farther than anywhere
    /// so far.
    Disproportion,
}

impl Refusal {
    /// All reasons for refusal, in the order of [`Refusals`].
    pub const ALL: [Self; 12] = [
        Self::NonManifold,
        Self::Boundary,
        Self::Link,
        Self::Flip,
        Self::Locked,
        Self::Tied,
        Self::Seam,
        Self::LastFaces,
        Self::Valence,
        Self::Volume,
        Self::Error,
        Self::Disproportion,
    ];

    /// Returns the name of the reason as used in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::NonManifold => "non_manifold",
            Self::Boundary => "boundary",
            Self::Link => "link",
            Self::Flip => "flip",
            Self::Locked => "locked",
            Self::Tied => "tied",
            Self::Seam => "seam",
            Self::LastFaces => "last_faces",
            Self::Valence => "valence",
            Self::Volume => "volume",
            Self::Error => "error",
            Self::Disproportion => "disproportion",
        }
    }
}

/// Counts of refused contractions by reason. A contraction that is refused again counts again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refusals([u64; Refusal::ALL.len()]);

impl Refusals {
    /// Returns the number of contractions refused for this reason.
    pub fn count(&self, refusal: Refusal) -> u64 {
        self.0[refusal as usize]
    }

    /// Iterates over the reasons with at least one refusal, with their counts.
    pub fn iter(&self) -> impl Iterator<Item = (Refusal, u64)> + '_ {
        Refusal::ALL.into_iter().map(|r| (r, self.count(r))).filter(|&(_, count)| count > 0)
    }

    pub(crate) fn add(&mut self, refusal: Refusal) {
        self.0[refusal as usize] += 1;
    }
}

impl AddAssign for Refusals {
    fn add_assign(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(count, more)| *count += more);
    }
}

/// Writes the count of every reason under its name.
#[cfg(feature = "serde")]
impl serde::Serialize for Refusals {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(Refusal::ALL.map(|refusal| (refusal.name(), self.count(refusal))))
    }
}

impl fmt::Display for Refusals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        for (refusal, count) in self.iter() {
            write!(f, "{separator}{} {count}", refusal.name())?;
            separator = ", ";
        }
        if separator.is_empty() { f.write_str("none") } else { Ok(()) }
    }
}
