//! Seams that give way.
//!
//! As long as anything else can be contracted at a price in proportion, seams, borders of materials
//! and vertices where three charts meet are kept: an edge is refused if a chart at one end does not
//! go on along it. Then they become costs. A chart that does not go on stays with its faces and
//! with its own values, extrapolated to the new place, until its last face is gone.

use crate::kernel::attributes::seam_costs::CostsAtSeams;
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::mesh::one_ring::{GHOST, Vertices, is_seam};
use crate::kernel::mesh::vertex::VertexFlags;
use crate::kernel::metric::Metric;
use crate::kernel::metric::edge_quadric::EdgeSide;
use crate::kernel::schedule::bucket_queue::{NONE, bucket};
use crate::kernel::simd::{LANES, widest};
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

impl<M: Metric, const K: usize> WedgeQuadrics<'_, M, K> {
    /// Lets seams give way if an edge that they refuse costs no more than the front. Returns
    /// whether they do.
    #[cold]
    pub(crate) fn give_way(&mut self, vertices: &Vertices, front: u16) -> bool {
        // Only then do costs count the edges that seams refuse.
        self.release = SeamRelease::Done;
        let cheapest = match self.corners.others.is_empty() {
            true => NONE,
            false => self.cheapest_over_seams(vertices),
        };
        if cheapest <= front && cheapest != NONE {
            return true;
        }
        self.release = match front {
            NONE => SeamRelease::Never,
            _ => SeamRelease::From(cheapest),
        };
        false
    }

    /// Returns the bucket of the cheapest edge that seams would refuse.
    fn cheapest_over_seams(&self, vertices: &Vertices) -> u16 {
        let mut least = f32::INFINITY;
        let (mut us, mut vs, mut len) = ([0; LANES], [0; LANES], 0);
        let shut = |v: u32| {
            vertices.get(v).flags.any(VertexFlags(VertexFlags::DEAD.0 | VertexFlags::SHUT.0))
        };
        let mut cost_all = |us: [u32; LANES], vs: [u32; LANES]| {
            let edges = (EdgeSide::Each(us), &vs);
            let costs = widest(CostsAtSeams { wedges: self, vertices, edges });
            least = costs.into_iter().fold(least, f32::min);
        };
        for v in vertices.ids().filter(|&v| is_seam(vertices, v) && !shut(v)) {
            for &w in vertices.neighbours(v).iter().filter(|&&w| w != GHOST && !shut(w)) {
                if !self.ends(vertices, v, w).is_ok_and(|ends| ends.cuts_seam) {
                    continue;
                }
                (us[len], vs[len], len) = (v, w, len + 1);
                if len == LANES {
                    cost_all(us, vs);
                    len = 0;
                }
            }
        }
        if len > 0 {
            for lane in len..LANES {
                (us[lane], vs[lane]) = (us[0], vs[0]);
            }
            cost_all(us, vs);
        }
        bucket(least)
    }
}
