//! Edges between the same two ties: contracted in one step, to one place, or not at all.

use glam::DVec3;
use meshlod_mesh::VertexId;

use crate::kernel::attributes::AttributeModel;
use crate::kernel::bound::BoundedStep;
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::collapse::{Collapse, Ends, Mobility};
use crate::kernel::collapse_loop::{
    CollapseLoop, Rejection, UV_FLIP_DELAY, is_out_of_proportion, within,
};
use crate::kernel::mesh::one_ring::{GHOST, Vertices};
use crate::kernel::mesh::vertex::VertexFlags;
use crate::kernel::metric::Metric;
use crate::kernel::metric::edge_quadric_f64::EdgeQuadricF64;
use crate::kernel::schedule::bucket_queue::{NONE, bucket, last_bucket};
use crate::refusal::Refusal;
use crate::surface::contracted::Freedom;
use crate::surface::ties::{TiedSurface, Ties, partners};

/// The surface with its ties.
struct Tied<'a, 'v> {
    vertices: &'a Vertices<'v>,
    ties: &'a Ties,
}

impl TiedSurface for Tied<'_, '_> {
    fn is_tied(&self, vertex: VertexId) -> bool {
        self.vertices.get(vertex.0).flags.any(VertexFlags::TIED)
    }

    fn tie_of(&self, vertex: VertexId) -> &[VertexId] {
        self.ties.with(vertex)
    }

    fn are_joined(&self, a: VertexId, b: VertexId) -> bool {
        self.vertices.neighbours(a.0).contains(&b.0)
    }

    /// Returns true if edges of one of these vertices must not be contracted for now, for the
    /// length of its ring or because it has neighbours in another part.
    fn is_crowded(&self, vertices: &[VertexId]) -> bool {
        vertices.iter().any(|v| self.vertices.get(v.0).flags.any(VertexFlags::SHUT))
    }
}

/// One of the edges that are contracted together.
struct TiedEdge {
    ends: Ends,
    ring: Box<EdgeRing>,
    /// Quadric of the geometry alone.
    quadric: EdgeQuadricF64,
}

/// Edges of one step, and their joint cost.
struct Joint {
    edges: Vec<TiedEdge>,
    /// Place of each new vertex relative to the middle of its edge.
    from_middle: DVec3,
    bucket: u16,
}

impl<A: AttributeModel> CollapseLoop<'_, A> {
    /// Contracts an edge between two ties together with all other edges between them. Returns the
    /// vertex that stays.
    ///
    /// All checks of all edges come first. In the history these are separate contractions, one
    /// after the other.
    #[cold]
    pub(crate) fn collapse_together(
        &mut self,
        edge: [u32; 2],
        front: u16,
    ) -> Result<u32, Rejection> {
        let ends =
            self.ends_together(edge).map_err(|refusal| Rejection::Refused(refusal, front))?;
        let Joint { mut edges, from_middle, bucket } = self.price_together(&ends, front)?;
        let refused = |refusal| Rejection::Refused(refusal, bucket);
        let first = &edges[0];
        let from = self.vertices.get(first.ends.v0).place();
        let place = match first.ends.is_free() {
            true => {
                within::<A::Metric>(self.room, from.as_dvec3() + first.quadric.half + from_middle)
            }
            false => from,
        };
        let mut steps = Vec::with_capacity(edges.len());
        for edge in &mut edges {
            steps.push(self.step_of(edge, place).map_err(refused)?);
        }
        let now = steps.iter().map(|step| step.1).fold(0.0, f32::max);
        let moved = steps.iter().map(|step| step.2).fold(0.0, f32::max);
        if let Some(bucket) = self.deferral.wait(now, moved, front) {
            return Err(Rejection::Deferred(bucket));
        }
        if is_out_of_proportion(now, self.error as f32, self.room) {
            return Err(refused(Refusal::Disproportion));
        }
        let later = bucket.saturating_add(UV_FLIP_DELAY).min(last_bucket());
        for (edge, (collapse, ..)) in edges.iter().zip(&steps) {
            let flips = self.model.preview(&self.vertices, &edge.ring, collapse);
            if flips && front < later {
                return Err(Rejection::Deferred(later));
            }
        }
        self.admit_together(&edges, &mut steps).map_err(refused)?;
        for (mut edge, (collapse, _, moved)) in edges.into_iter().zip(steps) {
            std::mem::swap(self.edge_ring, &mut *edge.ring);
            self.model.preview(&self.vertices, self.edge_ring, &collapse);
            self.commit(&collapse, &edge.quadric, moved, front);
            if let Some(ties) = &mut self.ties {
                ties.leave(VertexId(collapse.ends.v1));
            }
        }
        Ok(ends[0].v0)
    }

    /// Decides which end of each edge between two ties is contracted into which: all vertices move,
    /// or all stay at one end.
    fn ends_together(&mut self, edge: [u32; 2]) -> Result<Vec<Ends>, Refusal> {
        let Self { vertices, model, ties, .. } = self;
        let Some(ties) = ties else { return Err(Refusal::Tied) };
        for v in edge {
            ties.with(VertexId(v)).iter().for_each(|member| vertices.refresh(member.0));
        }
        let mut others = Vec::new();
        let tied = Tied { vertices, ties };
        let mut freedom = partners(&tied, edge.map(VertexId), &mut others)?;
        let edges: Vec<[u32; 2]> =
            std::iter::once(edge).chain(others.into_iter().map(|edge| edge.map(|v| v.0))).collect();
        let mut all = Vec::with_capacity(edges.len());
        for &[a, b] in &edges {
            let ends = model.orient(vertices, a, b)?;
            let own = match ends.is_free() {
                true => Freedom::Free,
                false => Freedom::At(usize::from(ends.v0 == b)),
            };
            freedom = freedom.and(own).ok_or(Refusal::Tied)?;
            all.push(ends);
        }
        // All edges keep their vertices on one side, or vertices of two ties would share a place.
        let is_seam = |v: &u32| vertices.get(*v).flags.any(VertexFlags::SEAM);
        let on_seam = all.iter().zip(&edges).find(|(_, edge)| edge.iter().any(is_seam));
        let (kept, free) = match (freedom, on_seam) {
            (Freedom::At(kept) | Freedom::AlongNormal(kept), _) => (kept, false),
            (Freedom::Free, Some((ends, edge))) => (usize::from(ends.v0 == edge[1]), true),
            (Freedom::Free, None) => (0, true),
        };
        for (ends, edge) in all.iter_mut().zip(&edges) {
            let (stays, goes) = (edge[kept], edge[1 - kept]);
            if ends.v0 != stays && edge.iter().any(is_seam) {
                return Err(Refusal::Seam);
            }
            // Tied vertices would not stay together if each moved along its own normal.
            let mobility = if free { Mobility::Free } else { Mobility::Fixed };
            *ends = match ends.v0 == stays {
                true => Ends { mobility, ..*ends },
                false => Ends { mobility, ..Ends::free(stays, goes) },
            };
        }
        Ok(all)
    }

    /// Gathers the one-rings of the edges, and computes their joint cost and the place of the new
    /// vertices.
    fn price_together(&mut self, ends: &[Ends], front: u16) -> Result<Joint, Rejection> {
        let refused = |refusal| Rejection::Refused(refusal, front);
        let Self { vertices, model, edge_ring, deferral, debts, .. } = self;
        let mut edges: Vec<TiedEdge> = Vec::with_capacity(ends.len());
        let mut joint: Option<EdgeQuadricF64> = None;
        let (mut onto, mut flags) = (0.0, VertexFlags::default());
        for &ends in ends {
            let mut ring = Box::new(EdgeRing::new(edge_ring.boundary_weight));
            ring.gather(vertices, ends.v0, ends.v1).map_err(refused)?;
            let [end0, end1] = [ends.v0, ends.v1].map(|v| vertices.get(v));
            flags.set(end0.flags);
            flags.set(end1.flags);
            let quadric = A::Metric::edge_quadric(&ring, end0, end1);
            let whole =
                if ends.is_free() { model.with_attributes(&ends, quadric) } else { quadric };
            if !ends.is_free() {
                onto += whole.at(-quadric.half) + f64::from(model.cost_onto(vertices, &ends));
            }
            joint = Some(joint.map_or(whole, |joint| joint.with(&whole)));
            edges.push(TiedEdge { ends, ring, quadric });
        }
        if !are_apart(&edges) {
            return Err(refused(Refusal::Tied));
        }
        let Some(mut joint) = joint else { return Err(refused(Refusal::Tied)) };
        let owed =
            |ends: &Ends| debts.owed([ends.v0, ends.v1].map(|v| vertices.slot(v)).into_iter());
        joint.level += ends.iter().map(owed).sum::<f64>();
        let free = ends[0].is_free();
        let from_middle =
            if free { A::Metric::optimum(&joint, deferral.allowed()) } else { -joint.half };
        let cost = if free { joint.at(from_middle) } else { onto };
        if !cost.is_finite() {
            return Err(refused(Refusal::Volume));
        }
        let short =
            f64::from(A::Metric::SHORT_FIRST) * joint.weight() * joint.half.length_squared();
        let mut cost = (cost.max(0.0) + short) as f32;
        if flags.any(VertexFlags::PROTECTED) {
            cost *= self.vertices.protection;
        }
        let reaches =
            |edge: &TiedEdge| from_middle.length_squared() <= f64::from(edge.ring.reach());
        match bucket(cost) {
            NONE => Err(refused(Refusal::Volume)),
            _ if free && !edges.iter().all(reaches) => Err(refused(Refusal::Volume)),
            // Costed alone the edge was cheaper, and would be tried again at once.
            bucket if bucket > front.saturating_add(A::Metric::SLACK) => {
                Err(Rejection::Deferred(bucket))
            }
            bucket => Ok(Joint { edges, from_middle, bucket }),
        }
    }

    /// Returns the contraction of one of the edges to `place`, the square of its own deviation, and
    /// that square with all earlier ones.
    fn step_of(
        &self,
        edge: &mut TiedEdge,
        place: glam::Vec3,
    ) -> Result<(Collapse, f32, f32), Refusal> {
        let TiedEdge { ends, ring, quadric } = edge;
        let [end0, end1] = [ends.v0, ends.v1].map(|v| self.vertices.get(v));
        let displacement = place - end0.place();
        ring.try_place(displacement)?;
        let from_middle = displacement.as_dvec3() - quadric.half;
        let mean_square =
            quadric.at(from_middle).max(0.0) / quadric.weight().max(f64::MIN_POSITIVE);
        let now = ring.deviation(displacement).max(mean_square as f32);
        let collapse =
            Collapse { ends: *ends, half: quadric.half, from_middle, place, displacement };
        Ok((collapse, now, now + end0.moved.max(end1.moved)))
    }

    /// Checks all edges against the error bound, if there is one, before any of them counts as
    /// contracted.
    fn admit_together(
        &mut self,
        edges: &[TiedEdge],
        steps: &mut [(Collapse, f32, f32)],
    ) -> Result<(), Refusal> {
        let Some(within) = &mut self.within else { return Ok(()) };
        let mut checked = Vec::with_capacity(edges.len());
        for (edge, (collapse, now, moved)) in edges.iter().zip(steps) {
            let Ends { v0, v1, .. } = collapse.ends;
            let from = self.vertices.get(v0).place();
            let step = BoundedStep {
                edge_ring: &edge.ring,
                ends: [v0, v1],
                from,
                displacement: collapse.displacement,
                now: *now,
            };
            let (travelled, farthest) = within.check(&step, *moved).ok_or(Refusal::Error)?;
            *moved = farthest;
            checked.push(([v0, v1], travelled));
        }
        checked.into_iter().for_each(|(ends, travelled)| within.carry_out(ends, travelled));
        Ok(())
    }

    /// Requeues vertices that are tied to changed ones: their edges may have partners now.
    #[cold]
    pub(crate) fn wake_tied(&mut self, kept: u32, front: u16) {
        let Some(ties) = &self.ties else { return };
        let ring = self.edge_ring.ids().iter().copied().filter(|&v| v != GHOST);
        let changed =
            ring.chain([kept]).filter(|&v| self.vertices.get(v).flags.any(VertexFlags::TIED));
        let others: Vec<u32> =
            changed.flat_map(|v| ties.with(VertexId(v)).iter().map(|other| other.0)).collect();
        for v in others {
            self.wake(v, front);
        }
    }
}

/// Returns true if no two of the edges touch the same face.
fn are_apart(edges: &[TiedEdge]) -> bool {
    let touches = |edge: &TiedEdge, other: &TiedEdge| {
        edge.ring.ids().iter().any(|&v| v == other.ends.v0 || v == other.ends.v1)
    };
    let mut pairs = (0..edges.len()).flat_map(|i| (0..edges.len()).map(move |j| (i, j)));
    pairs.all(|(i, j)| i == j || !touches(&edges[i], &edges[j]))
}
