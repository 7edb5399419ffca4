//! Measures how far the surface around an edge would be from the input after a step.

use std::sync::Mutex;

use glam::Vec3;
use meshlod_mesh::FaceId;
use meshlod_spatial::Sheet;

use crate::kernel::bound::input_surface::{Covered, InputSurface};
use crate::kernel::bound::moved_part::{Beyond, Measured, MovedPart};
use crate::kernel::bound::probe::Probe;
use crate::kernel::bound::step::BoundedStep;
use crate::kernel::collapse::deviation::FaceFan;
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::mesh::one_ring::GHOST;

/// A single step that goes this many times as far as the bound is refused without measuring.
const TOO_FAR: f32 = 2.0;

/// Number of points on each old edge that are compared with the new faces.
const EDGE_POINTS: usize = 3;

/// Working memory of a measurement.
pub(crate) struct Gauge<'v> {
    /// The faces around the edge, before and after.
    old: FaceFan,
    new: FaceFan,
    sheet: Sheet<'v>,
}

/// Gauges for all threads that measure side by side.
pub(crate) struct Gauges<'v> {
    input: &'v InputSurface,
    free: Mutex<Vec<Gauge<'v>>>,
}

impl<'v> Gauges<'v> {
    pub(crate) fn new(input: &'v InputSurface) -> Self {
        Self { input, free: Mutex::default() }
    }

    /// Lends a gauge.
    pub(crate) fn with<T>(&self, work: impl FnOnce(&mut Gauge<'v>) -> T) -> T {
        let free = || self.free.lock().expect("no holder of the lock panics");
        let lent = free().pop();
        let mut gauge = lent.unwrap_or_else(|| {
            let (old, new) = (FaceFan::default(), FaceFan::default());
            Gauge { old, new, sheet: self.input.sheet() }
        });
        let result = work(&mut gauge);
        free().push(gauge);
        result
    }
}

impl Gauge<'_> {
    /// Measures the distance of the surface from the input after a step.
    pub(crate) fn measure(&mut self, moved: &MovedPart<'_>, step: &BoundedStep<'_>) -> Measured {
        let limit = moved.limit_at(&step.ends);
        if step.now.sqrt() > TOO_FAR * limit {
            return Err(Beyond::Surface);
        }
        self.old.lay_old(step.edge_ring);
        self.new.lay_new(step.edge_ring, step.displacement);
        if self.old_edges_to_new_faces(step.edge_ring) > limit + moved.travelled_before(step) {
            return Err(Beyond::Surface);
        }
        // Where a step was refused before, this most often sees it at the first point.
        let input_to_new = self.input_to_new_faces(moved, step, limit)?;
        let apex = step.from + step.displacement;
        let mut near = None;
        let at_apex = moved.input.distance(apex, &mut near, [0.0, limit]).ok_or(Beyond::Surface)?;
        let farthest = at_apex.max(input_to_new);
        if farthest < moved.near * limit && limit == moved.max_error {
            return Ok(farthest);
        }
        let near = near.expect("a distance is to a face");
        let of_faces = self.new_faces_to_input(moved, step, limit, near);
        of_faces.map_or(Err(Beyond::Surface), |of_faces| Ok(farthest.max(of_faces)))
    }

    /// Returns the largest distance of the new faces from the input, `near` being a face of it that
    /// is near the new vertex; `None` if it is beyond the bound. Where no faces of the input cover them, it is that of sampled points, or counts as
    /// beyond if the bound has not been held before.
    fn new_faces_to_input(
        &mut self,
        moved: &MovedPart<'_>,
        step: &BoundedStep<'_>,
        limit: f32,
        near: FaceId,
    ) -> Option<f32> {
        let &BoundedStep { edge_ring, from, displacement, .. } = step;
        let apex = from + displacement;
        let (mut farthest, mut is_unknown) = (0.0f32, false);
        for i in (0..edge_ring.len).filter(|&i| edge_ring.is_face(i)) {
            let [to, next] = [i, i + 1].map(|i| from + edge_ring.relative(i));
            match moved.input.covered(&mut self.sheet, [apex, to, next], near, limit) {
                Covered::Within(bound) => farthest = farthest.max(bound),
                Covered::Beyond => return None,
                Covered::Unknown if limit < moved.max_error => return None,
                Covered::Unknown => is_unknown = true,
            }
        }
        let probed = if is_unknown { probe_new_faces(moved, step, limit)? } else { 0.0 };
        Some(farthest.max(probed))
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

    /// Returns the largest distance of the input vertices merged into the ends from the new faces.
    /// They are beyond the bound if a point around was within that of the old faces and is not
    /// within that of the new ones.
    fn input_to_new_faces(
        &self,
        moved: &MovedPart<'_>,
        step: &BoundedStep<'_>,
        limit: f32,
    ) -> Measured {
        let &BoundedStep { edge_ring, ends, from, .. } = step;
        let most = limit * limit;
        let mut farthest = 0.0f32;
        let ring = edge_ring.ids().iter().copied().filter(|&v| v != GHOST);
        for (i, head) in ends.into_iter().chain(ring).enumerate() {
            for merged in moved.merged(head) {
                for place in moved.places(merged.at).map(|place| place - from) {
                    if self.new.is_far_from(place, most) && self.old.is_far_from(place, most) {
                        continue;
                    }
                    let apart = self.new.squared(place);
                    if apart > most {
                        if self.old.squared(place) <= most {
                            return Err(Beyond::Input(merged));
                        }
                    } else if i < ends.len() {
                        farthest = farthest.max(apart);
                    }
                }
            }
        }
        Ok(farthest.sqrt())
    }
}

/// Returns the largest distance of sampled points of the new faces from the input; `None` if it is
/// beyond the bound.
fn probe_new_faces(moved: &MovedPart<'_>, step: &BoundedStep<'_>, limit: f32) -> Option<f32> {
    let &BoundedStep { edge_ring, from, displacement, .. } = step;
    let mut probe = Probe::new(moved.input, limit);
    let apex = (from + displacement, probe.at(from + displacement)?);
    for i in 0..edge_ring.len {
        let to = from + edge_ring.relative(i);
        let at_end = if edge_ring.ids[i] == GHOST {
            0.0
        } else {
            let at_end = moved.travelled_at(edge_ring.ids[i]).min(limit);
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
