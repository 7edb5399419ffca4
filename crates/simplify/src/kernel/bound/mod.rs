//! The error bound, enforced by measuring distances from the input.
//!
//! The estimate of how far the surface has moved adds squares, which misses steps that all go the
//! same way. So the distances travelled are also added as lengths. Where their sum comes near the
//! bound, the surface is compared with the input: the input vertices merged into the vertices
//! around with the new faces, and the new faces with the faces of the input that lie over them, or
//! at points where there are none.
//!
//! Read in this order:
//!
//! | module | what it holds |
//! |---|---|
//! | `step` | a contraction that is asked for |
//! | `input_surface` | the input, its sharp edges, and which of its faces lie over a new one |
//! | `moved_part` | the surface as it has moved, and what of the input is merged where |
//! | `gauge`, `probe` | the measurement of a step |
//! | `look_ahead` | measurements of the next steps, side by side |

mod gauge;
pub(crate) mod input_surface;
mod look_ahead;
mod moved_part;
pub(crate) mod probe;
mod step;

use crate::kernel::bound::gauge::Gauges;
use crate::kernel::bound::input_surface::{EdgeSamples, InputSurface};
use crate::kernel::bound::look_ahead::LookAhead;
use crate::kernel::bound::moved_part::MovedPart;
pub(crate) use crate::kernel::bound::step::BoundedStep;
use crate::kernel::mesh::one_ring::VertexStore;

/// Part of the bound within which a new vertex stands for the faces around it, where the level is
/// compared with the input later: docs/notes/kernel.md has figures.
const NEAR: f32 = 0.4;

/// Bound on the distance between surface and input, for the whole surface.
pub(crate) struct ErrorBound<'m> {
    input: &'m InputSurface,
    between: EdgeSamples,
    /// The bound, in the frame's units.
    max_error: f32,
    /// Part of the bound within which a new vertex stands for the faces around it; 0 if it never does.
    near: f32,
    /// Rings of merged input vertices: the next one of each, through the one that is live.
    next: Vec<u32>,
    /// Distance that the surface has moved at each vertex, all steps added up.
    travelled: Vec<f32>,
    /// Fraction of the bound that holds at each vertex; empty if the whole bound holds everywhere.
    parts: Vec<f32>,
}

/// Error bound of one part of the surface.
pub(crate) struct BoundPart<'v> {
    moved: MovedPart<'v>,
    gauges: Gauges<'v>,
    ahead: LookAhead,
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
        Self {
            input,
            between: input.between(max_error),
            max_error,
            near: 0.0,
            next,
            travelled,
            parts,
        }
    }

    /// Leaves more to a comparison of the level with the input, which tells where the insides of new
    /// faces are beyond the bound.
    pub(crate) fn compared(self) -> Self {
        Self { near: NEAR, ..self }
    }

    /// Splits the bound into consecutive vertex ranges of the given lengths.
    pub(crate) fn split(&mut self, lengths: &[usize]) -> Vec<BoundPart<'_>> {
        let Self { input, between, max_error, near, next, travelled, parts: of_vertices } = self;
        let (mut next, mut travelled, mut base) = (&mut next[..], &mut travelled[..], 0);
        let mut of_vertices = &mut of_vertices[..];
        let mut parts = Vec::with_capacity(lengths.len());
        for &len in lengths {
            let (own_next, other_next) = next.split_at_mut(len);
            let (own_travelled, other_travelled) = travelled.split_at_mut(len);
            let (own_parts, other_parts) = of_vertices.split_at_mut(len.min(of_vertices.len()));
            let moved = MovedPart {
                input,
                between,
                max_error: *max_error,
                near: *near,
                base,
                next: own_next,
                travelled: own_travelled,
                parts: own_parts,
            };
            let (gauges, ahead) = (Gauges::new(input), LookAhead::default());
            parts.push(BoundPart { moved, gauges, ahead });
            (next, travelled, of_vertices) = (other_next, other_travelled, other_parts);
            base += len as u32;
        }
        parts
    }
}

impl BoundPart<'_> {
    /// Returns the bound that holds at all of some vertices, in the frame's units.
    pub(crate) fn limit_at(&self, vertices: &[u32]) -> f32 {
        self.moved.limit_at(vertices)
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
        let travelled = self.moved.travelled_with(step);
        if self.moved.is_sure(step, travelled) {
            return Some((travelled, estimate));
        }
        let found = self.ahead.take(step).unwrap_or_else(|| {
            let found = self.gauges.with(|gauge| gauge.measure(&self.moved, step));
            self.moved.remember(&found);
            found
        });
        let farthest = found.ok()?;
        Some((farthest, farthest * farthest))
    }

    /// Counts a step as carried out, with the total distance travelled.
    pub(crate) fn carry_out(&mut self, ends: [u32; 2], travelled: f32) {
        self.moved.carry_out(ends, travelled);
        self.ahead.forget_around(ends[0]);
    }

    /// Returns true if it pays to plan the next steps: many are measured, and others can help.
    pub(crate) fn looks_ahead(&mut self) -> bool {
        self.ahead.begin()
    }

    /// Plans a step, to be measured by [`Self::look_ahead`] if it has to be measured at all.
    pub(crate) fn plan(&mut self, step: &BoundedStep<'_>) {
        let travelled = self.moved.travelled_with(step);
        if !self.moved.is_sure(step, travelled) {
            self.ahead.plan(step);
        }
    }

    /// Measures all planned steps, side by side. Each is admitted in its turn as if it were measured
    /// then: by what was found, unless a step around it was carried out in between.
    pub(crate) fn look_ahead(&mut self) {
        let Self { moved, gauges, ahead } = self;
        ahead.measure(|step| gauges.with(|gauge| gauge.measure(moved, step)));
        ahead.found().for_each(|found| moved.remember(found));
    }
}
