//! Why a contraction may not happen, and how often each reason was met.

use std::fmt;
use std::ops::AddAssign;

/// Why a contraction may not happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[repr(u8)]
pub enum Refusal {
    /// The edge has three faces or more.
    NonManifold,
    /// It would join two boundaries across the surface, or take a boundary off its course.
    Boundary,
    /// Its ends have a common neighbour other than its wings [DEGN99].
    Link,
    /// A face would turn over or lose its area.
    Flip,
    /// Two of its vertices are locked.
    Locked,
    /// Vertices that are tied to its own cannot go with them.
    Tied,
    /// Attributes on one side of a seam would have nowhere to go.
    Seam,
    /// It would remove the last faces of a component.
    LastFaces,
    /// More faces meet in its ends than are looked at.
    Valence,
    /// No place among the vertices around conserves the volume; by `qem`, none costs least.
    Volume,
    /// It would move the surface further than the target error.
    Error,
}

impl Refusal {
    /// Every reason, in the order of [`Refusals`].
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

    /// Its name in reports.
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

/// How often each reason was met. A candidate tried again counts again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refusals([u64; Refusal::ALL.len()]);

impl Refusals {
    /// How often this reason was met.
    pub fn count(&self, refusal: Refusal) -> u64 {
        self.0[refusal as usize]
    }

    /// The reasons that were met, and how often.
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
