//! Batches of edges, costed eight at a time.

use crate::kernel::attributes::AttributeModel;
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::metric::edge_quadric::EdgeSide;
use crate::kernel::schedule::edge_costs::costs;
use crate::kernel::simd::LANES;

/// Up to `ROOM` edges to be costed.
pub(crate) struct Batch<const ROOM: usize> {
    us: [u32; ROOM],
    vs: [u32; ROOM],
    len: usize,
}

impl<const ROOM: usize> Batch<ROOM> {
    pub(crate) fn new() -> Self {
        Self { us: [0; ROOM], vs: [0; ROOM], len: 0 }
    }

    /// Returns true if there is room for `more` edges.
    #[inline(always)]
    pub(crate) fn has_room(&self, more: usize) -> bool {
        self.len + more <= ROOM
    }

    /// Adds an edge `if_so`, without a branch.
    #[inline(always)]
    pub(crate) fn push(&mut self, u: u32, v: u32, if_so: bool) {
        (self.us[self.len], self.vs[self.len]) = (u, v);
        self.len += usize::from(if_so);
    }

    /// Reports the cost of each edge in order, and empties the batch.
    #[inline(always)]
    pub(crate) fn cost_all(
        &mut self,
        vertices: &Vertices,
        model: &impl AttributeModel,
        mut report: impl FnMut([u32; 2], f32),
    ) {
        let mut start = 0;
        while start < self.len {
            // Lanes beyond the end repeat the first edge.
            let (mut us, mut vs) = ([self.us[start]; LANES], [self.vs[start]; LANES]);
            for lane in 0..LANES.min(self.len - start) {
                (us[lane], vs[lane]) = (self.us[start + lane], self.vs[start + lane]);
            }
            let costs = costs(vertices, model, EdgeSide::Each(us), &vs);
            for lane in 0..LANES.min(self.len - start) {
                report([us[lane], vs[lane]], costs[lane]);
            }
            start += LANES;
        }
        self.len = 0;
    }
}
