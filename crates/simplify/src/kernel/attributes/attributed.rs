//! [`AttributeModel`] and [`AttributeStore`] for quadrics at the wedges.

use std::ops::Range;

use meshlod_mesh::Attributes;

use crate::kernel::attributes::attribute_quadric::{
    AttributeQuadric, add_attribute_quadrics, add_pair_f64, add_unpaired_f64,
};
use crate::kernel::attributes::update_at_seams::UpdateAtSeams;
use crate::kernel::attributes::uv_flips::UvFlipsAtSeams;
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::attributes::wedge_store::WedgeStore;
use crate::kernel::attributes::{AttributeModel, AttributeStore, RecordedValues};
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::collapse::{Collapse, Ends};
use crate::kernel::handles::PER_CUT;
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::mesh::vertex::VertexQuadric;
use crate::kernel::metric::Metric;
use crate::kernel::metric::edge_quadric::{Costs, EdgeQuadrics, EdgeSide};
use crate::kernel::metric::edge_quadric_f64::EdgeQuadricF64;
use crate::kernel::simd::{LANES, widest};
use crate::refusal::Refusal;

impl<M: Metric, const K: usize> AttributeModel for WedgeQuadrics<'_, M, K> {
    type Metric = M;

    #[inline(always)]
    fn add_attribute_quadrics(&self, sides: [EdgeSide<u32>; 2], edges: &mut EdgeQuadrics) {
        let quadric = |v: u32| self.quadrics.of_vertex(v).unwrap_or(&self.none);
        add_attribute_quadrics(sides, quadric, edges);
    }

    #[inline(always)]
    fn orient(&self, vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal> {
        self.ends(vertices, v, target)
    }

    #[inline(always)]
    fn seam_costs(
        &self,
        vertices: &Vertices,
        us: EdgeSide<u32>,
        vs: &[u32; LANES],
    ) -> Option<Costs> {
        self.costs_at_seams(vertices, us, vs)
    }

    fn hold_seams(&mut self) -> bool {
        !std::mem::replace(self.seams_hold, true)
    }

    #[inline(always)]
    fn with_attributes(&self, ends: &Ends, mut quadric: EdgeQuadricF64) -> EdgeQuadricF64 {
        for &[s0, s1] in ends.wedge_pairs.pairs() {
            add_pair_f64(&mut quadric, self.quadric(s0), self.quadric(s1));
        }
        let half = quadric.half;
        for (end, from) in [(0, -half), (1, half)] {
            for slot in self.unpaired(ends, end) {
                add_unpaired_f64(&mut quadric, self.quadric(slot), from);
            }
        }
        quadric
    }

    fn cost_onto(&self, vertices: &Vertices, ends: &Ends) -> f32 {
        let by = vertices.get(ends.v0).place() - vertices.get(ends.v1).place();
        let to = |&[s0, s1]: &[u32; 2]| self.quadric(s1).cost_onto(by, &self.quadric(s0).values());
        ends.wedge_pairs.pairs().iter().map(to).sum::<f32>() + self.unpaired_onto(ends, by)
    }

    #[inline(always)]
    fn preview(&mut self, vertices: &Vertices, edge_ring: &EdgeRing, collapse: &Collapse) -> bool {
        match self.has_seam(vertices, edge_ring, collapse.ends) {
            true => widest(UvFlipsAtSeams { wedges: self, vertices, edge_ring, collapse }),
            false => self.preview_smooth(edge_ring, collapse),
        }
    }

    #[inline(always)]
    fn apply(
        &mut self,
        vertices: &mut Vertices,
        edge_ring: &EdgeRing,
        collapse: &Collapse,
    ) -> VertexQuadric {
        if self.has_seam(vertices, edge_ring, collapse.ends) {
            return widest(UpdateAtSeams { wedges: self, vertices, edge_ring, collapse });
        }
        self.move_uncosted(edge_ring, collapse, None);
        self.apply_smooth(edge_ring, collapse);
        VertexQuadric::default()
    }

    type Whole = [AttributeQuadric<K>; PER_CUT];

    fn part(&mut self, vertices: &Vertices, copies: [[u32; 2]; PER_CUT]) -> Self::Whole {
        let whole = copies.map(|[v, _]| *self.quadric(v));
        for [v, copy] in copies {
            *self.quadrics.get_mut(copy) = *self.quadric(v);
            self.carried.copy_all(copy, v);
            *self.merged_into.get_mut(copy) = copy;
        }
        for v in copies.into_iter().flatten() {
            *self.quadrics.get_mut(v) = self.renewed(vertices, v);
        }
        whole
    }

    fn rejoin(&mut self, vertices: [u32; PER_CUT], whole: Self::Whole) {
        for (v, quadric) in vertices.into_iter().zip(whole) {
            *self.quadrics.get_mut(v) = quadric;
        }
    }

    #[inline(always)]
    fn prefetch(&self, v: u32) -> u32 {
        let quadric = self.quadric(v);
        quadric.squares[0].x.to_bits() ^ quadric.channels.last().map_or(0, |last| last.w.to_bits())
    }

    fn record(&mut self, vertex: u32) {
        if self.corners.are_given {
            self.record_values(vertex);
        }
        self.record.steps += 1;
    }

    fn skip_record(&mut self) {
        self.record.steps += 1;
    }

    fn recorded(&mut self) -> Vec<RecordedValues> {
        std::mem::take(self.record).values
    }
}

impl<M: Metric, const K: usize> AttributeStore for WedgeStore<'_, M, K> {
    type Metric = M;
    type Part<'p>
        = WedgeQuadrics<'p, M, K>
    where
        Self: 'p;

    fn cut(&mut self, parts: &[Range<usize>]) {
        self.cut_into(parts);
    }

    fn parts(&mut self, count: usize) -> Vec<WedgeQuadrics<'_, M, K>> {
        self.in_parts(count)
    }

    fn attributes(&self, faces: impl Iterator<Item = (u32, [u32; 3])>) -> Option<Attributes> {
        self.corners.are_given.then(|| self.to_attributes(faces))
    }

    fn all_attributes(&self, faces: impl Iterator<Item = [u32; 3]>) -> Option<Attributes> {
        self.corners.are_given.then(|| self.to_all_attributes(faces))
    }
}
