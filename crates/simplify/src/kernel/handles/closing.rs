//! The step that closes a handle.

use crate::kernel::attributes::AttributeModel;
use crate::kernel::collapse_loop::{CollapseLoop, PlacedEdge, Rejection, is_out_of_proportion};
use crate::kernel::handles::PER_CUT;
use crate::kernel::handles::neck::{Neck, across, are_joined};
use crate::kernel::metric::Metric;
use crate::kernel::schedule::bucket_queue::{bucket, last_bucket, min_cost_in};
use crate::refusal::Refusal;

/// Faces that close a cut, and those that it takes away.
const FACES: usize = 2;

/// Mean square distance of a triangle from its edges, relative to the square of the radius of the
/// inscribed circle.
const MEAN_IN_TRIANGLE: f32 = 1.0 / 6.0;

/// Both contractions of a handle that closes, and what the step costs.
struct Closing {
    near: PlacedEdge,
    far: PlacedEdge,
    bucket: u16,
    /// Squared distance by which the step moves the surface.
    moved: f32,
}

impl<A: AttributeModel> CollapseLoop<'_, A> {
    /// Contracts an edge that goes around a handle on both of its sides, and so closes the handle.
    /// Returns the near vertex that stays.
    #[cold]
    pub(crate) fn close_handle(&mut self, edge: [u32; 2], front: u16) -> Result<u32, Rejection> {
        let refused = |refusal| Rejection::Refused(refusal, front);
        let spare = self.handles.as_ref().and_then(|handles| handles.spare());
        // Within an error bound, and for an observer, topology stays.
        let is_seen = self.within.is_some() || self.log.is_some() || self.ties.is_some();
        let Some(first_copy) = spare.filter(|_| !is_seen) else {
            return Err(refused(Refusal::Link));
        };
        let mut rejection = refused(Refusal::Link);
        for w in across(&mut self.vertices, edge) {
            match self.close_at([edge[0], edge[1], w], first_copy, front) {
                Err(Rejection::Refused(Refusal::Link, _)) => {}
                Err(other) => rejection = other,
                done => return done,
            }
        }
        Err(rejection)
    }

    /// Closes a handle whose neck has these vertices, of which the first two are an edge.
    fn close_at(&mut self, three: [u32; 3], first_copy: u32, front: u16) -> Result<u32, Rejection> {
        let refused = Rejection::Refused(Refusal::Link, front);
        let Some(neck) = Neck::new(&mut self.vertices, three) else { return Err(refused) };
        let weight = self.edge_ring.boundary_weight;
        let uncut = neck.cut::<A::Metric>(&mut self.vertices, first_copy, weight);
        let whole = self.model.part(&self.vertices, neck.copies(first_copy));
        let closing = self.price_closing(&neck, first_copy, front).and_then(|closing| {
            match are_joined(&mut self.vertices, [three[0], first_copy]) {
                true => Ok(closing),
                false => Err(refused),
            }
        });
        match closing {
            Ok(closing) => Ok(self.close(&neck, first_copy, &closing, front)),
            Err(rejection) => {
                uncut.restore(&mut self.vertices);
                self.model.rejoin(neck.vertices, whole);
                Err(rejection)
            }
        }
    }

    /// Places both new vertices of a cut, and checks the cost of the whole step.
    fn price_closing(
        &mut self,
        neck: &Neck,
        first_copy: u32,
        front: u16,
    ) -> Result<Closing, Rejection> {
        let [v0, v1, w] = neck.vertices;
        let [a, b, c] = [v0, v1, w].map(|v| self.vertices.get(v).place());
        let area = 0.5 * (b - a).cross(c - a).length();
        let around = a.distance(b) + b.distance(c) + c.distance(a);
        let radius = 2.0 * area / around.max(f32::MIN_POSITIVE);
        let far = self.place(first_copy, first_copy + 1, last_bucket())?;
        let near = self.place(v0, v1, last_bucket())?;
        let lid =
            A::Metric::vanishing_cost(2.0 * area, FACES as f32, MEAN_IN_TRIANGLE * radius * radius);
        let cost = [&near, &far].iter().map(|edge| min_cost_in(edge.bucket())).sum::<f32>() + lid;
        let now = near.now.max(far.now).max(radius * radius);
        let moved = near.moved(&self.vertices).max(far.moved(&self.vertices)).max(now);
        if is_out_of_proportion(now, self.error as f32, self.room) {
            return Err(Rejection::Refused(Refusal::Disproportion, front));
        }
        let bucket = bucket(cost).min(last_bucket());
        let bucket = self.deferral.delay(moved, bucket).unwrap_or(bucket);
        match bucket > front.saturating_add(A::Metric::SLACK) {
            true => Err(Rejection::CostRose(bucket)),
            false => Ok(Closing { near, far, bucket, moved }),
        }
    }

    /// Contracts both copies of the edge.
    fn close(&mut self, neck: &Neck, first_copy: u32, closing: &Closing, front: u16) -> u32 {
        if let Some(handles) = &mut self.handles {
            handles.close(&mut self.vertices, neck, first_copy);
        }
        self.live_faces += FACES;
        if let Some(components) = &mut self.components {
            components.cut(neck.copies(first_copy), FACES as u32);
        }
        let Closing { near, far, moved, .. } = closing;
        let later = front.max(closing.bucket);
        let kept = self.contract_placed(near, *moved, front);
        let copy = self.contract_placed(far, *moved, front);
        for v in [copy, first_copy + PER_CUT as u32 - 1] {
            self.defer(v, later);
        }
        kept
    }
}
