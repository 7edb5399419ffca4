//! Attributes in the costs and contractions of the kernel.

use crate::kernel::attributes::attribute_quadric::{join, join_alone, join_one};
use crate::kernel::attributes::update_at_seams::UpdateAtSeams;
use crate::kernel::attributes::uv_flips::UvFlipsAtSeams;
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::attributes::{AttributeModel, RecordedValues};
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::collapse::{Collapse, Ends};
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::mesh::vertex::VertexQuadric;
use crate::kernel::metric::Metric;
use crate::kernel::metric::edge_quadric::{Costs, EdgeQuadrics, EdgeSide};
use crate::kernel::metric::edge_quadric_f64::EdgeQuadricF64;
use crate::kernel::simd::{LANES, widest};
use crate::refusal::Refusal;
use meshlod_mesh::Attributes;

impl<M: Metric, const K: usize> AttributeModel for WedgeQuadrics<'_, M, K> {
    type Metric = M;

    const IN_PARTS: bool = false;

    fn side_by_side(self, _: usize) -> Vec<Self> {
        vec![self]
    }

    #[inline(always)]
    fn join(&self, sides: [EdgeSide<u32>; 2], edges: &mut EdgeQuadrics) {
        join(sides, |slot| self.field(slot), edges);
    }

    #[inline(always)]
    fn order(&self, vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal> {
        self.ends(vertices, v, target)
    }

    #[inline(always)]
    fn at_seams(&self, vertices: &Vertices, us: EdgeSide<u32>, vs: &[u32; LANES]) -> Option<Costs> {
        self.costs_at_seams(vertices, us, vs)
    }

    #[inline(always)]
    fn whole(&self, ends: &Ends, mut swept: EdgeQuadricF64) -> EdgeQuadricF64 {
        for &[s0, s1] in ends.met.pairs() {
            join_one(&mut swept, self.field(s0), self.field(s1));
        }
        let half = swept.half;
        for (end, from) in [(0, -half), (1, half)] {
            for slot in self.alone(ends, end) {
                join_alone(&mut swept, self.field(slot), from);
            }
        }
        swept
    }

    fn onto(&self, vertices: &Vertices, ends: &Ends) -> f32 {
        let by = vertices.get(ends.v0).place() - vertices.get(ends.v1).place();
        let to = |&[s0, s1]: &[u32; 2]| self.field(s1).onto(by, &self.field(s0).values());
        ends.met.pairs().iter().map(to).sum::<f32>() + self.alone_onto(ends, by)
    }

    #[inline(always)]
    fn look_ahead(&mut self, vertices: &Vertices, edge_ring: &EdgeRing, placed: &Collapse) -> bool {
        match self.has_seam(vertices, edge_ring, placed.ends) {
            true => widest(UvFlipsAtSeams { wedges: self, vertices, edge_ring, placed }),
            false => self.look_ahead_smooth(edge_ring, placed),
        }
    }

    #[inline(always)]
    fn contract(
        &mut self,
        vertices: &mut Vertices,
        edge_ring: &EdgeRing,
        placed: &Collapse,
    ) -> VertexQuadric {
        if self.has_seam(vertices, edge_ring, placed.ends) {
            return widest(UpdateAtSeams { wedges: self, vertices, edge_ring, placed });
        }
        self.move_rest(edge_ring, placed, None);
        self.contract_smooth(edge_ring, placed);
        VertexQuadric::default()
    }

    #[inline(always)]
    fn prefetch(&self, v: u32) -> u32 {
        let field = self.field(v);
        field.squares[0].x.to_bits() ^ field.channels.last().map_or(0, |last| last.w.to_bits())
    }

    fn attributes(&self, faces: impl Iterator<Item = (u32, [u32; 3])>) -> Option<Attributes> {
        self.corners.are_given.then(|| self.to_attributes(faces))
    }

    fn all_attributes(&self, faces: impl Iterator<Item = [u32; 3]>) -> Option<Attributes> {
        self.corners.are_given.then(|| self.to_all_attributes(faces))
    }

    fn record(&mut self, vertex: u32) {
        if self.corners.are_given {
            self.record_values(vertex);
        }
        self.logged += 1;
    }

    fn skip_record(&mut self) {
        self.logged += 1;
    }

    fn recorded(&mut self) -> Vec<RecordedValues> {
        self.logged = 0;
        std::mem::take(&mut self.record)
    }
}
