//! Costs of edges at seams, eight at a time.
//!
//! An edge along a seam has a pair of slots on each side. The second pair goes into an unused lane,
//! if there is one. Some edges must contract one end onto the other: both costs are computed, and
//! each edge takes the one that applies.

use glam::Vec3;

use crate::kernel::attributes::attribute_quadric::{
    add_attribute_quadrics_and_onto, unpaired_quadric,
};
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::collapse::Ends;
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::mesh::vertex::{NO_VERTEX, VertexFlags};
use crate::kernel::metric::edge_quadric::{
    Costs, EdgeQuadric, EdgeQuadrics, EdgeSide, SymmetricMatrix, VertexQuadrics, lane_of,
};
use crate::kernel::metric::{Metric, edges_between, least_costs};
use crate::kernel::simd::{LANES, Row, Row3, SimdTask, widest};

impl<M: Metric, const K: usize> WedgeQuadrics<'_, M, K> {
    /// Returns the costs of eight edges if any of their vertices is on a seam. Edges without such
    /// an end are costed as if both ends were free.
    #[inline(always)]
    pub(crate) fn costs_at_seams(
        &self,
        vertices: &Vertices,
        us: EdgeSide<u32>,
        vs: &[u32; LANES],
    ) -> Option<Costs> {
        let (mut any, mut floor) = (0, 0);
        for lane in 0..LANES {
            let u = vertices.get(us.get(lane));
            any |= u.flags.0 | vertices.get(vs[lane]).flags.0;
            floor |= u.floor;
        }
        if !VertexFlags(any).any(VertexFlags::SEAM) {
            return None;
        }
        let costs = widest(CostsAtSeams { wedges: self, vertices, edges: (us, vs) });
        Some(Costs { costs, any_special: VertexFlags(any).any(VertexFlags::SPECIAL) || floor > 0 })
    }

    /// Returns the cost of the unpaired slots of `v1` when it moves by `by` to the place of `v0`.
    pub(crate) fn unpaired_onto(&self, ends: &Ends, by: Vec3) -> f32 {
        let cost = |slot: u32| {
            let quadric = self.quadric(slot);
            let mut values = quadric.best_values(by.as_dvec3());
            let leader = self.leader(&ends.wedge_pairs, slot);
            if leader != slot {
                self.layers.copy_textures(&mut values, &self.quadric(leader).values());
            }
            quadric.cost_onto(by, &values)
        };
        self.unpaired(ends, 1).map(cost).sum()
    }
}

/// SIMD task that costs eight edges.
pub(crate) struct CostsAtSeams<'a, 'm, 'v, M, const K: usize> {
    pub(crate) wedges: &'a WedgeQuadrics<'m, M, K>,
    pub(crate) vertices: &'a Vertices<'v>,
    pub(crate) edges: (EdgeSide<u32>, &'a [u32; LANES]),
}

impl<M: Metric, const K: usize> SimdTask for CostsAtSeams<'_, '_, '_, M, K> {
    type Output = Row;

    #[inline(always)]
    fn work(self) -> Row {
        let Self { wedges, vertices, edges: (us, vs) } = self;
        let mut laid = SeamBatch::new();
        laid.lay(wedges, vertices, us, vs);
        if laid.lend() { laid.costs(wedges, vertices) } else { [f32::INFINITY; LANES] }
    }
}

/// Motion of the ends of an edge.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Motion {
    Not,
    Free,
    /// The second end is contracted onto the first, which may move along its normal where seams hold.
    Onto,
}

/// Eight edges with their pairs of slots.
struct SeamBatch {
    ends: [[u32; LANES]; 2],
    slots: [[u32; LANES]; 2],
    ways: [Motion; LANES],
    /// Edges that have unpaired slots.
    unpaired: [Option<Ends>; LANES],
    /// Second pairs: the lane of the edge, and the slots.
    others: [(usize, [u32; 2]); LANES],
    others_len: usize,
    /// Lanes lent to the first of these.
    lent: [usize; LANES],
    lent_len: usize,
}

impl SeamBatch {
    #[inline(always)]
    fn new() -> Self {
        Self {
            ends: [[0; LANES]; 2],
            slots: [[NO_VERTEX; LANES]; 2],
            ways: [Motion::Not; LANES],
            unpaired: [None; LANES],
            others: [(0, [NO_VERTEX; 2]); LANES],
            others_len: 0,
            lent: [0; LANES],
            lent_len: 0,
        }
    }

    #[inline(always)]
    fn lay<M: Metric, const K: usize>(
        &mut self,
        wedges: &WedgeQuadrics<'_, M, K>,
        vertices: &Vertices,
        us: EdgeSide<u32>,
        vs: &[u32; LANES],
    ) {
        for lane in 0..LANES {
            let (u, v) = (us.get(lane), vs[lane]);
            let flags = VertexFlags(vertices.get(u).flags.0 | vertices.get(v).flags.0);
            // Lanes beyond the end repeat the first edge.
            let again = lane > 0 && (u, v) == (us.get(0), vs[0]);
            if flags.any(VertexFlags::SHUT) || again {
                self.put(lane, [u, v], [NO_VERTEX; 2], Motion::Not);
            } else if !flags.any(VertexFlags::SEAM) {
                self.put(lane, [u, v], [u, v], Motion::Free);
            } else if let Ok(ends) = wedges.ends(vertices, u, v) {
                self.put_ends(lane, &ends);
            } else {
                self.put(lane, [u, v], [NO_VERTEX; 2], Motion::Not);
            }
        }
    }

    #[inline(always)]
    fn put(&mut self, lane: usize, ends: [u32; 2], slots: [u32; 2], way: Motion) {
        (self.ends[0][lane], self.ends[1][lane]) = (ends[0], ends[1]);
        (self.slots[0][lane], self.slots[1][lane]) = (slots[0], slots[1]);
        self.ways[lane] = way;
    }

    #[inline(always)]
    fn put_ends(&mut self, lane: usize, ends: &Ends) {
        let Ends { v0, v1, wedge_pairs, .. } = ends;
        self.put(
            lane,
            [*v0, *v1],
            wedge_pairs.pairs()[0],
            if ends.is_free() { Motion::Free } else { Motion::Onto },
        );
        if let Some(other) = wedge_pairs.other() {
            self.others[self.others_len] = (lane, other);
            self.others_len += 1;
        }
        if wedge_pairs.has_unpaired[1] || (ends.is_free() && wedge_pairs.has_unpaired[0]) {
            self.unpaired[lane] = Some(*ends);
        }
    }

    /// Lends unused lanes to second pairs. Returns whether any lane is in use.
    #[inline(always)]
    fn lend(&mut self) -> bool {
        let mut wanted = 0;
        for lane in 0..LANES {
            if self.ways[lane] != Motion::Not {
                wanted += 1;
            } else if self.lent_len < self.others_len {
                let (of, [s0, s1]) = self.others[self.lent_len];
                let ends = [self.ends[0][of], self.ends[1][of]];
                self.put(lane, ends, [s0, s1], Motion::Not);
                self.lent[self.lent_len] = lane;
                self.lent_len += 1;
            }
        }
        wanted > 0
    }

    #[inline(always)]
    fn costs<M: Metric, const K: usize>(
        &self,
        wedges: &WedgeQuadrics<'_, M, K>,
        vertices: &Vertices,
    ) -> Row {
        let first = VertexQuadrics::of(vertices, EdgeSide::Each(self.ends[0]));
        let second = VertexQuadrics::of(vertices, EdgeSide::Each(self.ends[1]));
        let mut edges = edges_between::<M>(&first, &second);
        let mut onto = onto_first::<M>(&first, &second, &edges.half);
        for &lane in &self.lent[..self.lent_len] {
            edges.set(lane, &EdgeQuadric::NONE);
            onto[lane] = 0.0;
        }
        let slots = [EdgeSide::Each(self.slots[0]), EdgeSide::Each(self.slots[1])];
        add_attribute_quadrics_and_onto(slots, |slot| wedges.quadric(slot), &mut edges, &mut onto);
        for (&lane, &(of, _)) in self.lent[..self.lent_len].iter().zip(&self.others) {
            let part = edges.part(lane);
            edges.add(of, &part);
            onto[of] += onto[lane];
        }
        if self.lent_len < self.others_len {
            self.add_other_sides(wedges, &mut edges, &mut onto);
        }
        self.add_unpaired(wedges, &mut edges, &mut onto);
        let mut costs = least_costs::<M>(&edges);
        for lane in 0..LANES {
            costs[lane] = match self.ways[lane] {
                Motion::Not => f32::INFINITY,
                Motion::Free => costs[lane],
                Motion::Onto => onto[lane],
            };
        }
        costs
    }

    /// Adds the second pairs that got no lane, each in the lane of its edge.
    #[inline(always)]
    fn add_other_sides<M: Metric, const K: usize>(
        &self,
        wedges: &WedgeQuadrics<'_, M, K>,
        edges: &mut EdgeQuadrics,
        onto: &mut Row,
    ) {
        let rest = &self.others[self.lent_len..self.others_len];
        let mut slots = [[NO_VERTEX; LANES]; 2];
        for &(of, [s0, s1]) in rest {
            (slots[0][of], slots[1][of]) = (s0, s1);
        }
        let mut parts = EdgeQuadrics::ZERO;
        parts.half = edges.half;
        let slots = [EdgeSide::Each(slots[0]), EdgeSide::Each(slots[1])];
        let mut part_onto = [0.0; LANES];
        add_attribute_quadrics_and_onto(
            slots,
            |slot| wedges.quadric(slot),
            &mut parts,
            &mut part_onto,
        );
        for &(of, _) in rest {
            edges.add(of, &parts.part(of));
            onto[of] += part_onto[of];
        }
    }

    /// Adds the unpaired slots one by one, as there are few.
    #[inline(always)]
    fn add_unpaired<M: Metric, const K: usize>(
        &self,
        wedges: &WedgeQuadrics<'_, M, K>,
        edges: &mut EdgeQuadrics,
        onto: &mut Row,
    ) {
        for (lane, ends) in self.unpaired.iter().enumerate() {
            let Some(ends) = ends else { continue };
            let half = edges.half.get(lane);
            if !ends.is_free() {
                onto[lane] += wedges.unpaired_onto(ends, -2.0 * half);
                continue;
            }
            for (end, from) in [(0, -half), (1, half)] {
                for slot in wedges.unpaired(ends, end) {
                    edges.add(lane, &unpaired_quadric(wedges.quadric(slot), from));
                }
            }
        }
    }
}

/// Returns the geometric cost of contracting each second end onto the first.
#[inline(always)]
fn onto_first<M: Metric>(first: &VertexQuadrics, second: &VertexQuadrics, half: &Row3) -> Row {
    let mut costs = [0.0; LANES];
    for (lane, cost) in costs.iter_mut().enumerate() {
        let (h, squares) = (half.get(lane), SymmetricMatrix(lane_of(&second.squares, lane)));
        let short = M::SHORT_FIRST * squares.trace() * h.dot(h);
        *cost = 4.0 * (h.dot(squares.apply(h)) + short) + M::offsets_onto(first, second, lane, h);
    }
    costs
}
