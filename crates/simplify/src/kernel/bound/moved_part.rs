//! A part of the surface that has moved: which input vertices are merged where, and how far it has
//! gone.

use glam::Vec3;

use crate::kernel::bound::input_surface::{EdgeSamples, InputSurface};
use crate::kernel::bound::step::BoundedStep;

/// Fraction of the bound up to which the sum of distances is trusted. Distances are taken at
/// vertices and planes only, and are sometimes larger in between. Greatest distances of the bunny,
/// fandisk-32k and the sample `fish` relative to a bound of .1 % of the diagonal: .5 1.00, 1.00,
/// 1.00; .7 1.40, 1.09, 1.40.
const SURE: f32 = 0.5;

/// Part of the surface, and the input that its distance is measured from.
pub(crate) struct MovedPart<'v> {
    pub(crate) input: &'v InputSurface,
    pub(crate) between: &'v EdgeSamples,
    /// The bound where none is lower, in the frame's units.
    pub(crate) max_error: f32,
    /// As in [`ErrorBound`](crate::kernel::bound::ErrorBound).
    pub(crate) near: f32,
    /// Id of the first vertex.
    pub(crate) base: u32,
    /// As in [`ErrorBound`](crate::kernel::bound::ErrorBound).
    pub(crate) next: &'v mut [u32],
    pub(crate) travelled: &'v mut [f32],
    pub(crate) parts: &'v mut [f32],
}

/// An input vertex with its predecessor in the ring of `head`.
#[derive(Clone, Copy)]
pub(crate) struct MergedVertex {
    pub(crate) head: u32,
    pub(crate) last: u32,
    pub(crate) at: u32,
}

/// Largest distance between surface and input around a step, or what is beyond the bound.
pub(crate) type Measured = Result<f32, Beyond>;

/// Reason why a step would bring the surface beyond the bound.
#[derive(Clone, Copy)]
pub(crate) enum Beyond {
    /// An input vertex, or a sample of an edge beside it.
    Input(MergedVertex),
    /// A point of the new faces, or of the old edges.
    Surface,
}

impl MovedPart<'_> {
    /// Returns the bound that holds at all of some vertices, in the frame's units.
    pub(crate) fn limit_at(&self, vertices: &[u32]) -> f32 {
        if self.parts.is_empty() {
            return self.max_error;
        }
        let of = |part: f32, &v: &u32| part.min(self.parts[self.slot(v)]);
        self.max_error * vertices.iter().fold(1.0, of)
    }

    /// Returns the distance travelled before a step, at its ends.
    pub(crate) fn travelled_before(&self, step: &BoundedStep<'_>) -> f32 {
        let [v0, v1] = step.ends.map(|v| self.travelled[self.slot(v)]);
        v0.max(v1)
    }

    /// Returns the distance travelled with a step.
    pub(crate) fn travelled_with(&self, step: &BoundedStep<'_>) -> f32 {
        let now = step.now.max(step.edge_ring.off_planes(step.displacement)).sqrt();
        self.travelled_before(step) + now
    }

    /// Returns true if a step need not be measured, given the distance travelled with it: where the
    /// bound has not been held before, sums have been wrong, be they zero.
    pub(crate) fn is_sure(&self, step: &BoundedStep<'_>, travelled: f32) -> bool {
        self.limit_at(&step.ends) == self.max_error && travelled <= SURE * self.max_error
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

    /// Returns the input vertices that are merged into a vertex, itself first.
    pub(crate) fn merged(&self, head: u32) -> impl Iterator<Item = MergedVertex> {
        let next = move |last: u32| {
            let at = self.next[self.slot(last)];
            (at != head).then_some(MergedVertex { head, last, at })
        };
        let first = MergedVertex { head, last: head, at: head };
        std::iter::successors(Some(first), move |merged| next(merged.at))
    }

    /// Returns the places that must stay near the surface for an input vertex: its own, and samples
    /// of edges around.
    pub(crate) fn places(&self, v: u32) -> impl Iterator<Item = Vec3> {
        std::iter::once(self.input.place(v)).chain(self.between.of(v).iter().copied())
    }

    /// Moves the input vertex that a step was refused for to directly after the head of its ring:
    /// what was too far once will most often be so again.
    pub(crate) fn remember(&mut self, found: &Measured) {
        let Err(Beyond::Input(MergedVertex { head, last, at })) = *found else { return };
        let [of_head, of_last, own] = [head, last, at].map(|v| self.slot(v));
        // Another step may have been refused for one of the ring in between.
        if last != head && at != head && self.next[of_last] == at {
            self.next[of_last] = self.next[own];
            self.next[own] = self.next[of_head];
            self.next[of_head] = at;
        }
    }

    #[inline(always)]
    fn slot(&self, v: u32) -> usize {
        (v - self.base) as usize
    }

    /// Returns the distance that the surface has travelled at a vertex.
    pub(crate) fn travelled_at(&self, v: u32) -> f32 {
        self.travelled[self.slot(v)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::collapse::edge_ring::EdgeRing;
    use crate::kernel::mesh::local_frame::Frame;

    #[test]
    fn where_the_bound_was_not_held_no_distance_is_sure() {
        let mesh = meshlod_fixtures::grid(2);
        let frame = Frame::new(&mesh, &mesh.bounds());
        let places: Vec<Vec3> = mesh.positions.iter().map(|&at| frame.to_local(at)).collect();
        let count = places.len();
        let faces = mesh.faces.iter().map(|face| face.map(|v| v.0));
        let input = &InputSurface::new(&mesh, frame, places, faces);
        let between = &input.between(1.0);
        let (edge_ring, ends) = (&EdgeRing::new(1.0), [0, 1]);
        let is_sure = |now: f32, parts: &mut [f32]| {
            let (next, travelled) = (&mut vec![0; count][..], &mut vec![0.0; count][..]);
            let moved = MovedPart {
                input,
                between,
                max_error: 1.0,
                near: 0.0,
                base: 0,
                next,
                travelled,
                parts,
            };
            let (from, displacement) = (Vec3::ZERO, Vec3::ZERO);
            let step = BoundedStep { edge_ring, ends, from, displacement, now };
            moved.is_sure(&step, moved.travelled_with(&step))
        };
        assert!(is_sure(0.0, &mut []) && is_sure(0.2, &mut []) && !is_sure(0.3, &mut []));
        for part in [0.0, 0.5] {
            assert!(!is_sure(0.0, &mut vec![part; count]));
        }
    }
}
