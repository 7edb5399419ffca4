//! The error bound, enforced by measuring distances from the input.
//!
//! The estimate of how far the surface has moved adds squares, which misses steps that all go the
//! same way. So the distances travelled are also added as lengths. Where their sum comes near the
//! bound, the surface is compared with the input: the input vertices merged into the vertices
//! around with the new faces, and the new faces with the faces of the input that lie over them, or
//! at points where there are none.

pub(crate) mod input_surface;
pub(crate) mod probe;

use glam::Vec3;
use meshlod_spatial::Sheet;

use crate::kernel::bound::input_surface::{Covered, EdgeSamples, InputSurface};
use crate::kernel::bound::probe::Probe;
use crate::kernel::collapse::deviation::FaceFan;
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::mesh::one_ring::{GHOST, VertexStore};

/// Fraction of the bound up to which the sum of distances is trusted. Distances are taken at
/// vertices and planes only, and are sometimes larger in between. Greatest distances of the bunny,
/// fandisk-32k and the sample `fish` relative to a bound of .1 % of the diagonal: .5 1.00, 1.00,
/// 1.00; .7 1.40, 1.09, 1.40.
const SURE: f32 = 0.5;

/// A single step that goes this many times as far as the bound is refused without measuring.
const TOO_FAR: f32 = 2.0;

/// Number of points on each old edge that are compared with the new faces.
const EDGE_POINTS: usize = 3;

/// Bound on the distance between surface and input, for the whole surface.
pub(crate) struct ErrorBound<'m> {
    input: &'m InputSurface,
    between: EdgeSamples,
    /// The bound, in the frame's units.
    max_error: f32,
    /// Rings of merged input vertices: the next one of each, through the one that is live.
    next: Vec<u32>,
    /// Distance that the surface has moved at each vertex, all steps added up.
    travelled: Vec<f32>,
    /// Fraction of the bound that holds at each vertex; empty if the whole bound holds everywhere.
    parts: Vec<f32>,
}

/// Error bound of one part of the surface.
pub(crate) struct BoundPart<'v> {
    input: &'v InputSurface,
    between: &'v EdgeSamples,
    max_error: f32,
    /// Bound of the step that is being checked.
    limit: f32,
    /// Id of the first vertex.
    base: u32,
    next: &'v mut [u32],
    travelled: &'v mut [f32],
    parts: &'v mut [f32],
    /// Working memory for the faces around an edge, before and after.
    old: FaceFan,
    new: FaceFan,
    sheet: Sheet<'v>,
}

impl<'m> ErrorBound<'m> {
    /// Sets a bound, in the frame's units, for the surface in its current state. `parts` are the
    /// parts of the bound that hold at the vertices; if there are none, the whole bound holds.
    ///
    /// Cost: O(n), n = vertices of the input.
    pub(crate) fn new(
        max_error: f32,
        mut parts: Vec<f32>,
        input: &'m InputSurface,
        store: &VertexStore,
    ) -> Self {
        let mut next: Vec<u32> = (0..store.all.len() as u32).collect();
        for (v, heir) in store.live_vertices().into_iter().enumerate().rev() {
            if heir as usize != v {
                next[v] = std::mem::replace(&mut next[heir as usize], v as u32);
                if !parts.is_empty() {
                    parts[heir as usize] = parts[heir as usize].min(parts[v]);
                }
            }
        }
        let travelled = store.all.iter().map(|vertex| vertex.moved.sqrt()).collect();
        Self { input, between: input.between(max_error), max_error, next, travelled, parts }
    }

    /// Splits the bound into consecutive vertex ranges of the given lengths.
    pub(crate) fn split(&mut self, lengths: &[usize]) -> Vec<BoundPart<'_>> {
        let Self { input, between, max_error, next, travelled, parts: of_vertices } = self;
        let (mut next, mut travelled, mut base) = (&mut next[..], &mut travelled[..], 0);
        let mut of_vertices = &mut of_vertices[..];
        let mut parts = Vec::with_capacity(lengths.len());
        for &len in lengths {
            let (own_next, other_next) = next.split_at_mut(len);
            let (own_travelled, other_travelled) = travelled.split_at_mut(len);
            let (own_parts, other_parts) = of_vertices.split_at_mut(len.min(of_vertices.len()));
            parts.push(BoundPart {
                input,
                between,
                max_error: *max_error,
                limit: *max_error,
                base,
                next: own_next,
                travelled: own_travelled,
                parts: own_parts,
                old: FaceFan::default(),
                new: FaceFan::default(),
                sheet: input.sheet(),
            });
            (next, travelled, of_vertices) = (other_next, other_travelled, other_parts);
            base += len as u32;
        }
        parts
    }
}

/// A contraction to be checked against the error bound.
pub(crate) struct BoundedStep<'a> {
    /// Ring of the edge, with the new vertex placed.
    pub(crate) edge_ring: &'a EdgeRing,
    /// Ends of the edge: `v1` is contracted into `v0`.
    pub(crate) ends: [u32; 2],
    /// Old place of `v0`.
    pub(crate) from: Vec3,
    /// New place relative to the old place of `v0`.
    pub(crate) displacement: Vec3,
    /// Squared deviation by this step alone.
    pub(crate) now: f32,
}

impl BoundPart<'_> {
    /// Returns the bound that holds at all of some vertices, in the frame's units.
    pub(crate) fn limit_at(&self, vertices: &[u32]) -> f32 {
        if self.parts.is_empty() {
            return self.max_error;
        }
        let of = |part: f32, &v: &u32| part.min(self.parts[self.slot(v)]);
        self.max_error * vertices.iter().fold(1.0, of)
    }

    /// Checks a step and counts it as carried out. Returns the squared distance of the surface from
    /// the input, or `estimate` where that cannot be near the bound; `None` if it is beyond the
    /// bound.
    pub(crate) fn admit(&mut self, step: &BoundedStep<'_>, estimate: f32) -> Option<f32> {
        let (travelled, moved) = self.check(step, estimate)?;
        self.carry_out(step.ends, travelled);
        Some(moved)
    }

    /// Checks a step. Returns the total distance travelled with it, and the result of
    /// [`Self::admit`].
    pub(crate) fn check(&mut self, step: &BoundedStep<'_>, estimate: f32) -> Option<(f32, f32)> {
        self.limit = self.limit_at(&step.ends);
        let [v0, v1] = step.ends.map(|v| self.slot(v));
        let before = self.travelled[v0].max(self.travelled[v1]);
        let travelled = before + step.now.max(step.edge_ring.off_planes(step.displacement)).sqrt();
        if travelled <= SURE * self.limit {
            return Some((travelled, estimate));
        }
        let farthest = self.measure(step, before)?;
        Some((farthest, farthest * farthest))
    }

    /// Counts a step as carried out, with the total distance travelled.
    pub(crate) fn carry_out(&mut self, ends: [u32; 2], travelled: f32) {
        let [v0, v1] = ends.map(|v| self.slot(v));
        self.travelled[v0] = travelled;
        self.next.swap(v0, v1);
        if !self.parts.is_empty() {
            self.parts[v0] = self.parts[v0].min(self.parts[v1]);
        }
    }

    /// Measures the distance of the surface from the input after a step; `None` if it is beyond the
    /// bound.
    fn measure(&mut self, step: &BoundedStep<'_>, before: f32) -> Option<f32> {
        if step.now.sqrt() > TOO_FAR * self.limit {
            return None;
        }
        self.old.lay_old(step.edge_ring);
        self.new.lay_new(step.edge_ring, step.displacement);
        if self.old_edges_to_new_faces(step.edge_ring) > self.limit + before {
            return None;
        }
        // Where a step was refused before, this most often sees it at the first point.
        let input_to_new = self.input_to_new_faces(step)?;
        Some(input_to_new.max(self.new_faces_to_input(step)?))
    }

    /// Returns the largest distance of the new faces from the input; `None` if it is beyond the
    /// bound. Where no faces of the input cover them, it is that of sampled points, or counts as
    /// beyond if the bound has not been held before.
    fn new_faces_to_input(&mut self, step: &BoundedStep<'_>) -> Option<f32> {
        let &BoundedStep { edge_ring, from, displacement, .. } = step;
        let apex = from + displacement;
        let mut near = None;
        let at_apex = self.input.distance(apex, &mut near, [0.0, self.limit])?;
        let (near, mut farthest, mut is_unknown) = (near?, at_apex, false);
        for i in (0..edge_ring.len).filter(|&i| edge_ring.is_face(i)) {
            let [to, next] = [i, i + 1].map(|i| from + edge_ring.relative(i));
            match self.input.covered(&mut self.sheet, [apex, to, next], near, self.limit) {
                Covered::Within(bound) => farthest = farthest.max(bound),
                Covered::Beyond => return None,
                Covered::Unknown if self.limit < self.max_error => return None,
                Covered::Unknown => is_unknown = true,
            }
        }
        let probed = if is_unknown { self.probe_new_faces(step)? } else { 0.0 };
        Some(farthest.max(probed))
    }

    /// Returns the largest distance of sampled points of the new faces from the input; `None` if it
    /// is beyond the bound.
    fn probe_new_faces(&self, step: &BoundedStep<'_>) -> Option<f32> {
        let &BoundedStep { edge_ring, from, displacement, .. } = step;
        let mut probe = Probe::new(self.input, self.limit);
        let apex = (from + displacement, probe.at(from + displacement)?);
        for i in 0..edge_ring.len {
            let to = from + edge_ring.relative(i);
            let at_end = if edge_ring.ids[i] == GHOST {
                0.0
            } else {
                let at_end = self.travelled[self.slot(edge_ring.ids[i])].min(self.limit);
                probe.along([apex, (to, at_end)])?;
                at_end
            };
            if edge_ring.is_face(i) {
                let next = from + edge_ring.relative(i + 1);
                probe.along([apex, (to.midpoint(next), at_end)])?;
            }
        }
        Some(probe.farthest())
    }

    /// Returns the largest distance of sampled points of the old edges from the new faces. The new
    /// faces may be nearer to the input by the error of the old edges.
    fn old_edges_to_new_faces(&self, edge_ring: &EdgeRing) -> f32 {
        let spokes = (0..edge_ring.len).filter(|&i| edge_ring.ids[i] != GHOST);
        let spokes = spokes.map(|i| (edge_ring.along * edge_ring.of_v1[i], edge_ring.relative(i)));
        // The edges of the dying faces that are not spokes.
        let is_face = |wing: usize| edge_ring.ghost != Some(wing);
        let first = is_face(0).then(|| (edge_ring.along, edge_ring.relative(0)));
        let last =
            is_face(edge_ring.of_v0).then(|| (Vec3::ZERO, edge_ring.relative(edge_ring.of_v0)));
        let edges = spokes.chain(first).chain(last).chain([(Vec3::ZERO, edge_ring.along)]);
        let part = |k: usize| k as f32 / (EDGE_POINTS + 1) as f32;
        let points = edges.flat_map(|(a, b)| (1..=EDGE_POINTS).map(move |k| a.lerp(b, part(k))));
        points.map(|point| self.new.squared(point)).fold(0.0, f32::max).sqrt()
    }

    /// Returns the largest distance of the input vertices merged into the ends from the new faces;
    /// `None` if a point around was within the bound of the old faces and is not within that of the
    /// new ones.
    fn input_to_new_faces(&mut self, step: &BoundedStep<'_>) -> Option<f32> {
        let &BoundedStep { edge_ring, ends, from, .. } = step;
        let max_error = self.limit * self.limit;
        let mut farthest = 0.0f32;
        let ring = edge_ring.ids().iter().copied().filter(|&v| v != GHOST);
        for (i, head) in ends.into_iter().chain(ring).enumerate() {
            let (mut last, mut at) = (head, head);
            loop {
                let here = [self.input.place(at)];
                for &place in here.iter().chain(self.between.of(at)) {
                    let place = place - from;
                    if self.new.is_far_from(place, max_error)
                        && self.old.is_far_from(place, max_error)
                    {
                        continue;
                    }
                    let apart = self.new.squared(place);
                    if apart > max_error {
                        if self.old.squared(place) <= max_error {
                            self.put_first(head, last, at);
                            return None;
                        }
                    } else if i < ends.len() {
                        farthest = farthest.max(apart);
                    }
                }
                (last, at) = (at, self.next[self.slot(at)]);
                if at == head {
                    break;
                }
            }
        }
        Some(farthest.sqrt())
    }

    /// Moves the vertex after `last` to directly after `head`: what was too far once will most
    /// often be so again.
    fn put_first(&mut self, head: u32, last: u32, at: u32) {
        if last != head && at != head {
            let [of_head, of_last, own] = [head, last, at].map(|v| self.slot(v));
            self.next[of_last] = self.next[own];
            self.next[own] = self.next[of_head];
            self.next[of_head] = at;
        }
    }

    #[inline(always)]
    fn slot(&self, v: u32) -> usize {
        (v - self.base) as usize
    }
}
