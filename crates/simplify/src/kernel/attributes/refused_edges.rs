//! Search for the cheapest of the edges that seams refuse, which decides when seams give way.

use crate::kernel::attributes::seam_costs::CostsAtSeams;
use crate::kernel::attributes::seam_release::SeamRelease;
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::mesh::one_ring::{GHOST, Vertices, is_seam};
use crate::kernel::mesh::vertex::VertexFlags;
use crate::kernel::metric::Metric;
use crate::kernel::metric::edge_quadric::EdgeSide;
use crate::kernel::schedule::bucket_queue::{NONE, bucket};
use crate::kernel::simd::{LANES, widest};

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
        let shut = |v: u32| vertices.get(v).flags.any(VertexFlags::INACTIVE);
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
