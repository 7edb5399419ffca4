//! Update of attributes by a contraction near seams, where the slots of every face are looked up.

use glam::Vec3;

use crate::kernel::attributes::attribute_quadric::AttributeQuadric;
use crate::kernel::attributes::face_wedges::FaceWedges;
use crate::kernel::attributes::update_smooth::dying_quadric;
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::collapse::{Collapse, Ends};
use crate::kernel::mesh::one_ring::{GHOST, Vertices, is_seam};
use crate::kernel::mesh::vertex::{VertexFlags, VertexQuadric};
use crate::kernel::metric::Metric;
use crate::kernel::simd::SimdTask;

/// SIMD task of a contraction near a seam, see [`WedgeQuadrics::apply_at_seams`].
pub(crate) struct UpdateAtSeams<'a, 'm, 'v, M, const K: usize> {
    pub(crate) wedges: &'a mut WedgeQuadrics<'m, M, K>,
    pub(crate) vertices: &'a mut Vertices<'v>,
    pub(crate) edge_ring: &'a EdgeRing,
    pub(crate) collapse: &'a Collapse,
}

impl<M: Metric, const K: usize> SimdTask for UpdateAtSeams<'_, '_, '_, M, K> {
    type Output = VertexQuadric;

    #[inline(always)]
    fn work(self) -> VertexQuadric {
        self.wedges.apply_at_seams(self.vertices, self.edge_ring, self.collapse)
    }
}

impl<M: Metric, const K: usize> WedgeQuadrics<'_, M, K> {
    /// Applies a contraction near a seam. Returns the seam quadrics of the new vertex.
    #[inline(always)]
    fn apply_at_seams(
        &mut self,
        vertices: &mut Vertices,
        edge_ring: &EdgeRing,
        collapse: &Collapse,
    ) -> VertexQuadric {
        let Ends { v0, v1, wedge_pairs, .. } = collapse.ends;
        let slots = std::mem::take(&mut self.scratch.slots);
        self.move_uncosted(edge_ring, collapse, Some(&slots));
        if M::IS_MEMORYLESS {
            self.remove_constraints(vertices, edge_ring, collapse);
        }
        self.update_charts(&wedge_pairs);
        let constraint = self.add_constraints(vertices, edge_ring, collapse, &slots);
        self.update_quadrics(edge_ring, collapse, &slots);
        for &[s0, s1] in wedge_pairs.pairs() {
            *self.merged_into.get_mut(s1) = s0;
        }
        for renewed in &self.scratch.renewed {
            *self.merged_into.get_mut(renewed.slot) = renewed.slot;
        }
        self.update_sectors(vertices, edge_ring, [v0, v1], &slots.apexes);
        self.scratch.slots = slots;
        M::renewed_seams(constraint, edge_ring.ghost.is_some())
    }

    /// Updates all quadrics around for the faces that change.
    #[inline(always)]
    fn update_quadrics(&mut self, edge_ring: &EdgeRing, collapse: &Collapse, slots: &FaceWedges) {
        let Self { quadrics, scratch, .. } = self;
        let apexes = &slots.apexes;
        scratch.quadric_changes::<M, true>(edge_ring, collapse.displacement, [&[0.0; K]; 3]);
        for (wing, of) in [0, edge_ring.of_v0].into_iter().zip(slots.dying) {
            if edge_ring.ghost != Some(wing) {
                let [v0, v1, other] = of.map(|slot| quadrics.get_mut(slot).values());
                quadrics.get_mut(of[2]).take(&dying_quadric::<M, K>(
                    edge_ring,
                    wing,
                    [&v0, &v1, &other],
                ));
            }
        }
        for (i, &slot) in apexes.iter().enumerate() {
            if i > 0 && slot == apexes[i - 1] {
                continue;
            }
            let mut values = [0.0; K];
            for (value, row) in values.iter_mut().zip(&scratch.after) {
                *value = row[i];
            }
            *quadrics.get_mut(slot) = AttributeQuadric::of_values(values);
        }
        for i in (0..edge_ring.len).filter(|&i| edge_ring.is_face(i)) {
            let [_, a, b] = slots.spokes[i];
            quadrics.get_mut(a).add(&scratch.changes[i]);
            quadrics.get_mut(b).add(&scratch.changes[i]);
            quadrics.get_mut(apexes[i]).add(&scratch.new[i]);
        }
    }

    /// Removes the seam quadrics of edges that change from the vertices around.
    fn remove_constraints(
        &self,
        vertices: &mut Vertices,
        edge_ring: &EdgeRing,
        collapse: &Collapse,
    ) {
        let Ends { v0, v1, .. } = collapse.ends;
        let any = is_seam(vertices, v0) || is_seam(vertices, v1);
        for i in (0..edge_ring.len).filter(|&i| edge_ring.ghost != Some(i)) {
            let w = edge_ring.ids[i];
            if !any && !is_seam(vertices, w) {
                continue;
            }
            let near = [i <= edge_ring.of_v0, i >= edge_ring.of_v0 || i == 0];
            for (apex, at, near) in [(v0, Vec3::ZERO, near[0]), (v1, edge_ring.along, near[1])] {
                if near && self.is_cut_edge(apex, w) {
                    let constraint = M::seam(edge_ring.relative(i) - at);
                    vertices.get_mut(w).quadric.take(&constraint);
                }
            }
        }
    }

    /// Adds the seam quadrics of the changed edges. Returns those of the new vertex.
    fn add_constraints(
        &self,
        vertices: &mut Vertices,
        edge_ring: &EdgeRing,
        collapse: &Collapse,
        slots: &FaceWedges,
    ) -> VertexQuadric {
        let apexes = &slots.apexes;
        let mut sum = VertexQuadric::default();
        let differ = |a: u32, b: u32| a != b && self.chart(a) != self.chart(b);
        for i in (0..edge_ring.len).filter(|&i| edge_ring.is_face(i)) {
            let before = (i + edge_ring.len - 1) % edge_ring.len;
            let (last, first) = (slots.spokes[before][2], slots.spokes[i][1]);
            if edge_ring.is_face(before)
                && (differ(apexes[before], apexes[i]) || differ(last, first))
            {
                let constraint = M::seam(edge_ring.relative(i) - collapse.displacement);
                if M::IS_MEMORYLESS {
                    vertices.get_mut(edge_ring.ids[i]).quadric.add(&constraint);
                }
                sum.add(&constraint);
            }
        }
        sum
    }

    /// Returns true if the charts differ across an edge at its end `v`.
    pub(crate) fn is_cut(&self, v: u32, w: u32) -> bool {
        self.seams.parted(v, w).is_some_and(|[a, b]| self.chart(a) != self.chart(b))
    }

    fn is_cut_edge(&self, v: u32, w: u32) -> bool {
        self.is_cut(v, w) || self.is_cut(w, v)
    }

    fn update_sectors(
        &mut self,
        vertices: &mut Vertices,
        edge_ring: &EdgeRing,
        [v0, v1]: [u32; 2],
        apexes: &[u32],
    ) {
        for (i, &w) in edge_ring.ids().iter().enumerate() {
            if w == GHOST || !is_seam(vertices, w) {
                continue;
            }
            let first = match i {
                0 => Some(v0),
                i if i == edge_ring.of_v0 => Some(v1),
                _ => None,
            };
            if !self.seams.rename(w, v1, v0, first) {
                vertices.get_mut(w).flags.clear(VertexFlags::SEAM);
            }
        }
        if is_seam(vertices, v0) || is_seam(vertices, v1) {
            let any = self.seams.set(v0, (edge_ring.ids(), apexes));
            let flags = &mut vertices.get_mut(v0).flags;
            if any { flags.set(VertexFlags::SEAM) } else { flags.clear(VertexFlags::SEAM) }
        }
    }
}
