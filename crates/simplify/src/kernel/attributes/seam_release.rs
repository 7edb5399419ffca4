//! Seams that give way.
//!
//! As long as anything else can be contracted at a price in proportion, seams, borders of materials
//! and vertices where three charts meet are kept: an edge is refused if a chart at one end does not
//! go on along it. Then they become costs. A chart that does not go on stays with its faces and
//! with its own values, extrapolated to the new place, until its last face is gone.

use crate::kernel::schedule::bucket_queue::bucket;
use crate::options::Topology;

/// Cost at the front, in the frame's units, below which seams hold. Edges are about one long there.
///
/// Below, the edges that seams refuse are not looked for: on the whole flight helmet that takes a
/// tenth of the time to 10 %. FLIP of the milk truck at 5 % is .273 from 0 on, .244 from 1 on; the
/// city and pirate are the same, the skyscraper at 50 % has .082 and .094.
const LEAST_FRONT: f32 = 1.0;

/// State of the seams: whether they hold, and for how long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SeamRelease {
    /// Seams always hold.
    Never,
    /// Seams hold until the front is in this bucket; then the cheapest edge that they refuse is
    /// looked for again.
    From(u16),
    /// Seams give way.
    Done,
}

impl SeamRelease {
    pub(crate) fn new(topology: Topology) -> Self {
        match topology {
            Topology::Free => Self::From(bucket(LEAST_FRONT)),
            Topology::Keep => Self::Never,
        }
    }

    /// Returns true if seams give way.
    #[inline(always)]
    pub(crate) fn is_done(self) -> bool {
        self == Self::Done
    }

    /// Returns true if seams hold, but may give way.
    pub(crate) fn may_come(self) -> bool {
        matches!(self, Self::From(_))
    }

    /// Returns true if it is time to look for the cheapest edge that seams refuse.
    #[inline(always)]
    pub(crate) fn is_asked(self, front: u16) -> bool {
        matches!(self, Self::From(next) if front >= next)
    }
}
