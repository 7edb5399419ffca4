//! Reasons to refuse a contraction, and their counts.

use std::fmt;
use std::ops::AddAssign;

/// Reason why a contraction is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Refusal {
    /// The edge has three or more faces.
    NonManifold,
    /// The contraction would join two boundaries across the surface, or move a vertex off its
    /// boundary.
    Boundary,
    /// The ends have a common neighbour other than the wings, so the link condition fails [DEGN99].
    Link,
    /// A face would flip or lose its area.
    Flip,
    /// Two of the contracted vertices are locked.
    Locked,
    /// The vertices tied to the contracted ones cannot move along.
    Tied,
    /// An attribute chart would be lost: the contraction does not follow the seam.
    Seam,
    /// The contraction would remove the last faces of a component.
    LastFaces,
    /// Too many faces meet at the contracted vertices.
    Valence,
    /// No suitable position conserves the volume or, in `qem`, minimizes the cost.
    Volume,
    /// The contraction would exceed the target error.
    Error,
}

impl Refusal {
    /// All reasons, in the order of [`Refusals`].
    pub const ALL: [Self; 11] = [
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
    ];

    /// Returns the name of the reason in reports.
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
        }
    }
}

/// Number of refusals by reason. A candidate that is tried again counts again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refusals([u64; Refusal::ALL.len()]);

impl Refusals {
    /// Returns the number of refusals for this reason.
    pub fn count(&self, refusal: Refusal) -> u64 {
        self.0[refusal as usize]
    }

    /// Iterates over the reasons that occurred, with their counts.
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
