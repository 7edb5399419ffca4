//! The loop: contracts edges, the cheapest first.
//!
//! 1. Take a batch of up to sixteen vertices, within an error bound sixty-four, from the cheapest
//!    bucket of the queue ([`CollapseLoop::take_batch`]).
//! 2. Recost those whose edge is stale; requeue those that have become too expensive
//!    ([`CollapseLoop::recost_batch`]).
//!    Within a bound, measure the steps of the batch side by side ([`CollapseLoop::look_ahead`]).
//! 3. Try the cheapest edge of the next vertex ([`CollapseLoop::contract`]): gather the one-ring of
//!    the edge, compute its cost and the optimal place ([`CollapseLoop::price`]), and put the new
//!    vertex there.
//! 4. Check for flipped faces, for the deviation from the old surface, for faces flipped in uv, and
//!    against the error bound. A contraction that deviates too far or flips a uv is deferred, not
//!    refused.
//! 5. Commit: update the rings, quadrics and attributes around ([`CollapseLoop::apply`]).
//! 6. Requeue the vertex that stays, a few buckets behind the front.
//!
//! A vertex has one queue entry, for its cheapest edge when it was last costed. Contractions nearby
//! only mark it as stale. It is recosted when its entry comes up, first by that one edge, and goes
//! ahead if the cost has risen by at most [`Metric::SLACK`] buckets.

mod placed_edge;
mod queueing;
mod ruin;

pub(crate) use crate::kernel::collapse_loop::placed_edge::PlacedEdge;
pub(crate) use crate::kernel::collapse_loop::ruin::{
    are_parts_stuck, is_out_of_proportion, is_seen,
};

use glam::{DVec3, Vec3};

use crate::kernel::attributes::AttributeModel;
use crate::kernel::bound::BoundPart;
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::collapse::{Collapse, Ends, Mobility};
use crate::kernel::collapse_loop::placed_edge::PricedEdge;
use crate::kernel::components::Components;
use crate::kernel::contraction_log::{Logged, LoggedContraction};
use crate::kernel::handles::Handles;
use crate::kernel::mesh::one_ring::{GHOST, Vertices};
use crate::kernel::mesh::vertex::{NO_VERTEX, VertexFlags};
use crate::kernel::metric::Metric;
use crate::kernel::metric::edge_quadric_f64::EdgeQuadricF64;
use crate::kernel::schedule::batch::Batch;
use crate::kernel::schedule::bucket_queue::{
    BATCH_LEN, BOUNDED_BATCH_LEN, BucketQueue, NONE, bucket, last_bucket,
};
use crate::kernel::schedule::deferral::Deferral;
use crate::kernel::schedule::edge_costs::{Cheapest, cheapest};
use crate::kernel::simd::{SimdTask, widest};
use crate::kernel::volume::{VolumeDebts, VolumeTally};
use crate::refusal::{Refusal, Refusals};
use crate::surface::ties::Ties;

/// Number of buckets behind the front at which a new vertex is queued without being costed: many
/// are gone before their entry comes up.
///
/// Mean error of horse-97k at 10 % and 1 %, and millions of instructions for both: costed at once
/// .00723, .0572, 849; 4 .00721, .0580; 6 .00720, .0578, 789; 8 .00723, .0586, 766; 10 .00727,
/// .0583.
const NEW_VERTEX_DELAY: u16 = 6;

/// Square of the distance, in halves of the edge, by which a place may be worse than the best one and
/// still be as good: what floats make of a corner of flat walls.
const AS_GOOD: f64 = 1e-6;

/// Number of buckets by which a contraction that flips a face in uv is deferred.
///
/// Flipped faces in the flight helmet at 25 % and 10 %, and FLIP of pirate at 5 %, which has few
/// faces left to remove: 0 95, 111, .314; 4 44, 51, .324; 8 21, 41, .348; 16 .348; refused for good
/// 9, 20, .393. FLIP is the same elsewhere.
pub(crate) const UV_FLIP_DELAY: u16 = 8;

/// A part of the surface being simplified, with its queue and its attributes.
pub(crate) struct CollapseLoop<'v, A> {
    pub(crate) vertices: Vertices<'v>,
    pub(crate) model: A,
    pub(crate) live_faces: usize,
    /// Square of the largest error estimate so far, in the frame's units.
    pub(crate) error: f64,
    /// Error bound that every contraction must respect, if one is set.
    pub(crate) within: Option<BoundPart<'v>>,
    /// Number of edges contracted.
    pub(crate) contractions: usize,
    pub(crate) refusals: Refusals,
    pub(crate) volume: VolumeTally,
    /// Contractions done so far, if an observer wants them.
    pub(crate) log: Option<Vec<Logged>>,
    /// True if an observer also wants the values of attributes.
    pub(crate) records_values: bool,
    /// Ties between vertices, if there are any.
    pub(crate) ties: Option<&'v mut Ties>,
    /// Components that may vanish as a whole, if any may.
    pub(crate) components: Option<&'v mut Components>,
    /// Handles that may close, if there are any.
    pub(crate) handles: Option<&'v mut Handles>,
    pub(crate) queue: &'v mut BucketQueue,
    pub(crate) edge_ring: &'v mut EdgeRing,
    pub(crate) deferral: &'v mut Deferral,
    pub(crate) debts: &'v mut VolumeDebts,
    /// Half the size of the input's box, centred in the frame and a little larger. A metric that
    /// preserves the volume keeps all vertices in it.
    pub(crate) room: Vec3,
}

/// Reason why the edge at the front was not contracted.
pub(crate) enum Rejection {
    /// Its cost now lies in this later bucket.
    CostRose(u16),
    /// It deviates too far for now, or flips a face in uv; it may be tried again in this bucket.
    Deferred(u16),
    /// It must not be contracted. The bucket is that of its cost.
    Refused(Refusal, u16),
}

impl<'v, A: AttributeModel> CollapseLoop<'v, A> {
    pub(crate) fn new(
        vertices: Vertices<'v>,
        model: A,
        queue: &'v mut BucketQueue,
        edge_ring: &'v mut EdgeRing,
        (deferral, debts): (&'v mut Deferral, &'v mut VolumeDebts),
        room: Vec3,
    ) -> Self {
        Self {
            vertices,
            model,
            live_faces: 0,
            error: 0.0,
            within: None,
            contractions: 0,
            refusals: Refusals::default(),
            volume: VolumeTally::default(),
            log: None,
            records_values: false,
            ties: None,
            components: None,
            handles: None,
            queue,
            edge_ring,
            deferral,
            debts,
            room,
        }
    }

    /// Contracts until at most `faces` are left, or the next edge lies in a bucket behind `last`,
    /// or no further contraction is possible.
    pub(crate) fn run(&mut self, faces: usize, last: u16) {
        widest(ContractAll { collapse_loop: self, faces, last });
    }

    /// Contracts edges, and between them removes each component once no edge costs less.
    #[inline(always)]
    fn contract_all(&mut self, faces: usize, last: u16) {
        loop {
            let component =
                self.next_component().filter(|&bucket| bucket <= last.min(last_bucket()));
            if let Some(until) = component.map_or(Some(last), |bucket| bucket.checked_sub(1)) {
                self.contract_edges(faces, until);
            }
            match component {
                Some(bucket) if self.live_faces > faces => {
                    self.vanish_up_to(bucket);
                }
                _ => return,
            }
        }
    }

    #[inline(always)]
    fn contract_edges(&mut self, faces: usize, last: u16) {
        while self.live_faces > faces && self.take_batch(last) {
            let (_, bucket) = self.queue.next();
            if let Some(v) = self.pop() {
                self.try_collapse(v, bucket);
            }
        }
    }

    /// Returns the bucket of the cheapest component that may vanish.
    fn next_component(&self) -> Option<u16> {
        self.components.as_ref().and_then(|components| components.next_bucket())
    }

    /// Takes the next vertex from the queue; `None` if its entry is out of date.
    #[inline(always)]
    fn pop(&mut self) -> Option<u32> {
        let (_, bucket) = self.queue.next();
        let v = self.queue.pop()?;
        let is_due = self.is_due(v, bucket);
        let vertex = self.vertices.get_mut(v);
        if vertex.bucket == bucket {
            vertex.bucket = NONE;
        }
        is_due.then_some(v)
    }

    /// Makes the next batch ready. Returns whether its bucket is at most `last`.
    #[inline(always)]
    fn take_batch(&mut self, last: u16) -> bool {
        let (next, front) = self.queue.next();
        if !next.is_empty() {
            return front <= last;
        }
        let len = if self.within.is_some() { BOUNDED_BATCH_LEN } else { BATCH_LEN };
        if !self.queue.take(last, len) {
            return false;
        }
        self.prefetch();
        self.recost_batch();
        let is_alone = self.ties.is_none();
        if self.within.as_mut().is_some_and(|within| within.looks_ahead()) && is_alone {
            self.look_ahead();
        }
        true
    }

    /// Recosts the stale vertices of the batch: first only their cheapest known edges, all of them
    /// at once. A vertex whose cost has risen beyond the slack is requeued.
    #[inline(always)]
    fn recost_batch(&mut self) {
        let (taken, front) = self.queue.next();
        let (mut next, len) = ([0; BOUNDED_BATCH_LEN], taken.len());
        next[..len].copy_from_slice(taken);
        let (mut changed, mut risen, mut count) =
            (Batch::<BOUNDED_BATCH_LEN>::new(), [0; BOUNDED_BATCH_LEN], 0);
        for &v in &next[..len] {
            if !self.is_due(v, front) {
                continue;
            }
            let target = self.target(v);
            let vertex = self.vertices.get_mut(v);
            changed.push(
                v,
                vertex.target,
                target.is_some() && vertex.flags.any(VertexFlags::STALE),
            );
            vertex.flags.clear(VertexFlags::STALE);
            risen[count] = v;
            count += usize::from(target.is_none());
        }
        changed.cost_all(&self.vertices, &self.model, |[v, _], cost| {
            risen[count] = v;
            count += usize::from(bucket(cost) > front.saturating_add(A::Metric::SLACK));
        });
        for &v in &risen[..count] {
            self.vertices.refresh(v);
            let Cheapest { bucket, target } = cheapest(&self.vertices, &self.model, v);
            let vertex = self.vertices.get_mut(v);
            vertex.target = target;
            if bucket > front.saturating_add(A::Metric::SLACK) {
                vertex.bucket = bucket;
                self.queue.push(v, bucket);
            }
        }
    }

    /// Measures the steps of the batch side by side, before each is tried in its turn.
    #[cold]
    fn look_ahead(&mut self) {
        let (taken, front) = self.queue.next();
        let (mut next, len) = ([0; BOUNDED_BATCH_LEN], taken.len());
        next[..len].copy_from_slice(taken);
        for &v in &next[..len] {
            let target = if self.is_due(v, front) { self.target(v) } else { None };
            let Some(target) = target else { continue };
            let Ok(placed) = self.place(v, target, front) else { continue };
            let moved = placed.moved(&self.vertices);
            if self.deferral.delay(moved, placed.priced.bucket).is_none() {
                let step = placed.step(self.edge_ring);
                if let Some(within) = &mut self.within {
                    within.plan(&step);
                }
            }
        }
        if let Some(within) = &mut self.within {
            within.look_ahead();
        }
    }

    /// Tries the cheapest edge of a vertex, and requeues the vertex accordingly.
    #[inline(always)]
    fn try_collapse(&mut self, v: u32, front: u16) {
        let Some(target) = self.target(v) else { return self.requeue(v, front, None) };
        let done = match self.ties {
            Some(_) if self.are_tied([v, target]) => self.collapse_together([v, target], front),
            _ => self.contract(v, target, front),
        };
        let done = match done {
            Err(Rejection::Refused(Refusal::Link, _)) if self.handles.is_some() => {
                self.close_handle([v, target], front)
            }
            done => done,
        };
        match done {
            Ok(kept) => self.defer(kept, front + NEW_VERTEX_DELAY),
            Err(Rejection::Deferred(bucket)) => self.defer(v, bucket),
            Err(Rejection::CostRose(bucket)) => self.requeue(v, front, Some((target, bucket))),
            Err(Rejection::Refused(refusal, bucket)) => {
                self.refusals.add(refusal);
                let vertex = self.vertices.get_mut(v);
                // The floor must rise, or the edge would be tried for ever.
                vertex.floor = bucket.max(front).max(vertex.floor.saturating_add(1));
                self.requeue(v, front, None);
            }
        }
    }

    #[inline]
    fn are_tied(&self, edge: [u32; 2]) -> bool {
        edge.iter().all(|&v| self.vertices.get(v).flags.any(VertexFlags::TIED))
    }

    /// Returns the other end of the vertex's cheapest edge when it was last costed, or the vertex
    /// that this end has been contracted into.
    #[inline(always)]
    fn target(&mut self, v: u32) -> Option<u32> {
        let mut target = self.vertices.get(v).target;
        if target == NO_VERTEX {
            return None;
        }
        if self.vertices.get(target).flags.any(VertexFlags::DEAD) {
            target = self.vertices.live_vertex(target);
            let vertex = self.vertices.get_mut(v);
            vertex.target = target;
            vertex.flags.set(VertexFlags::STALE);
        }
        let barred = self.vertices.get(target).flags.any(VertexFlags::SHUT);
        (target != v && !barred).then_some(target)
    }

    /// Gathers the one-ring of an edge, and computes its cost and the place of the new vertex.
    #[inline(always)]
    fn price(&mut self, v: u32, target: u32, front: u16) -> Result<PricedEdge, Rejection> {
        let Self { vertices, model, edge_ring, deferral, debts, .. } = self;
        let refused = |refusal| Rejection::Refused(refusal, front);
        let ends = model.orient(vertices, v, target).map_err(refused)?;
        let Ends { v0, v1, mobility, .. } = ends;
        edge_ring.gather(vertices, v0, v1).map_err(refused)?;
        let (end0, end1) = (vertices.get(v0), vertices.get(v1));
        let quadric = A::Metric::edge_quadric(edge_ring, end0, end1);
        let free = ends.is_free();
        let whole = if free { model.with_attributes(&ends, quadric) } else { quadric };
        let owed = debts.owed(edge_ring.ids().iter().chain(&[v0, v1]).map(|&v| vertices.slot(v)));
        let aim = EdgeQuadricF64 { level: whole.level + owed, ..whole };
        let from_middle = match mobility {
            Mobility::Free => A::Metric::optimum(&aim, deferral.allowed()),
            Mobility::Leaning => {
                let best = A::Metric::optimum(&aim, deferral.allowed());
                if is_as_good(&aim, -quadric.half, best) { -quadric.half } else { best }
            }
            Mobility::AlongNormal if !edge_ring.is_open(vertices, v0) => {
                A::Metric::optimum_along_normal(&aim, end0, deferral.allowed())
            }
            _ => -quadric.half,
        };
        let attributes = if free { 0.0 } else { f64::from(model.cost_onto(vertices, &ends)) };
        let cost = whole.at(from_middle) + attributes;
        if !cost.is_finite() {
            return Err(refused(Refusal::Volume));
        }
        let short =
            f64::from(A::Metric::SHORT_FIRST) * whole.weight() * quadric.half.length_squared();
        let mut cost = (cost.max(0.0) + short) as f32;
        if VertexFlags(end0.flags.0 | end1.flags.0).any(VertexFlags::PROTECTED) {
            cost *= vertices.protection;
        }
        match bucket(cost) {
            NONE => Err(refused(Refusal::Volume)),
            bucket if bucket > front.saturating_add(A::Metric::SLACK) => {
                Err(Rejection::CostRose(bucket))
            }
            bucket => Ok(PricedEdge { ends, quadric, from_middle, bucket }),
        }
    }

    /// Places the new vertex of an edge whose cost is within the slack of the front.
    #[inline(always)]
    pub(crate) fn place(
        &mut self,
        v: u32,
        target: u32,
        front: u16,
    ) -> Result<PlacedEdge, Rejection> {
        let priced = self.price(v, target, front)?;
        let PricedEdge { ends, quadric, from_middle, bucket } = priced;
        let Self { vertices, edge_ring, room, .. } = self;
        let refused = |refusal| Rejection::Refused(refusal, bucket);
        let is_far = from_middle.length_squared() > f64::from(edge_ring.reach());
        // The place as it is stored, so that the normals are those of the actual faces.
        let from = vertices.get(ends.v0).place();
        let mut place = match ends.mobility {
            Mobility::Fixed => from,
            Mobility::AlongNormal | Mobility::Leaning if is_far => from,
            Mobility::Free if is_far => return Err(refused(Refusal::Volume)),
            _ => within::<A::Metric>(*room, from.as_dvec3() + quadric.half + from_middle),
        };
        if let Err(refusal) = edge_ring.try_place(place - from) {
            if ends.mobility == Mobility::Free || place == from {
                return Err(refused(refusal));
            }
            place = from;
            edge_ring.try_place(Vec3::ZERO).map_err(refused)?;
        }
        let from_middle = (place - from).as_dvec3() - quadric.half;
        // A mean square distance: attributes do not count.
        let mean_square =
            quadric.at(from_middle).max(0.0) / quadric.weight().max(f64::MIN_POSITIVE);
        let now = edge_ring.deviation(place - from).max(mean_square as f32);
        Ok(PlacedEdge { priced, from, place, now })
    }

    /// Contracts an edge after all checks. Returns the vertex that stays.
    #[inline(always)]
    fn contract(&mut self, v: u32, target: u32, front: u16) -> Result<u32, Rejection> {
        let placed = self.place(v, target, front)?;
        let mut moved = placed.moved(&self.vertices);
        let PlacedEdge { priced: PricedEdge { ends, ref quadric, bucket, .. }, now, .. } = placed;
        let refused = |refusal| Rejection::Refused(refusal, bucket);
        if let Some(bucket) = self.deferral.wait(now, moved, front) {
            return Err(Rejection::Deferred(bucket));
        }
        let collapse = placed.collapse();
        if is_seen(now, self.room) && self.is_ruin(now, front) {
            return Err(refused(Refusal::Disproportion));
        }
        let Self { vertices, model, edge_ring, .. } = self;
        let flips = model.preview(vertices, edge_ring, &collapse);
        let later = bucket.saturating_add(UV_FLIP_DELAY).min(last_bucket());
        if flips && front < later {
            return Err(Rejection::Deferred(later));
        }
        if let Some(within) = &mut self.within {
            let step = placed.step(edge_ring);
            moved = within.admit(&step, moved).ok_or_else(|| refused(Refusal::Error))?;
        }
        self.commit(&collapse, quadric, moved, front);
        Ok(ends.v0)
    }

    /// Returns true if a step would ruin the shape: it is out of proportion, or while most parts can
    /// go no further, the rest would pay for them at any price.
    ///
    /// Where components may still vanish, nothing is stuck, and within an error bound that decides.
    #[cold]
    fn is_ruin(&mut self, now: f32, front: u16) -> bool {
        if is_out_of_proportion(now, self.error as f32, self.room) {
            return true;
        }
        if self.within.is_some() || self.next_component().is_some() {
            return false;
        }
        let Self { vertices, deferral, live_faces, .. } = self;
        deferral.is_beyond_price((front, *live_faces), || are_parts_stuck(vertices))
    }

    /// Contracts an edge that has been placed and checked before, and has still the same ring.
    /// Returns the vertex that stays.
    pub(crate) fn contract_placed(&mut self, placed: &PlacedEdge, moved: f32, front: u16) -> u32 {
        let Self { vertices, model, edge_ring, .. } = self;
        let (collapse, quadric) = (placed.collapse(), &placed.priced.quadric);
        let Ends { v0, v1, .. } = collapse.ends;
        let again = edge_ring.gather(vertices, v0, v1);
        again.and_then(|()| edge_ring.try_place(collapse.displacement)).expect("checked before");
        model.preview(vertices, edge_ring, &collapse);
        self.commit(&collapse, quadric, moved, front);
        v0
    }

    /// Carries out a contraction that has passed all checks, and records it.
    #[inline(always)]
    pub(crate) fn commit(
        &mut self,
        collapse: &Collapse,
        quadric: &EdgeQuadricF64,
        moved: f32,
        front: u16,
    ) {
        let Ends { v0, v1, mobility, .. } = collapse.ends;
        let Collapse { place, displacement, .. } = *collapse;
        self.contractions += 1;
        if let Some(handles) = &mut self.handles {
            handles.merge(v0, v1);
        }
        self.error = self.error.max(moved.into());
        let lost = quadric.level - quadric.normal.dot(displacement.as_dvec3() - quadric.half);
        let is_open = self.edge_ring.is_open(&self.vertices, v0);
        self.volume.add(place, lost, is_open, collapse.is_held());
        self.deferral.pay(front);
        let Self { vertices, edge_ring, debts, .. } = self;
        let around = edge_ring.ids().iter().copied().chain([v0, v1]);
        let owed = debts.take(around.map(|v| vertices.slot(v)));
        let conserves = mobility != Mobility::Fixed && A::Metric::METHOD.conserves_volume();
        let lost = if conserves && !is_open { lost } else { 0.0 };
        let slot = (self.vertices.slot(v0), self.vertices.all.len());
        self.debts.settle(slot, (owed, lost), (quadric.normal, quadric.half));
        if let Some(log) = &mut self.log {
            let done = LoggedContraction { kept: v0, gone: v1, place, moved, front };
            log.push(Logged::Contraction(done));
        }
        self.apply(collapse, quadric, moved, front);
        if self.records_values {
            self.model.record(v0);
        }
        if self.ties.is_some() {
            self.wake_tied(v0, front);
        }
    }

    /// Updates vertices, rings, quadrics and attributes for a contraction.
    #[inline(always)]
    fn apply(&mut self, collapse: &Collapse, quadric: &EdgeQuadricF64, moved: f32, front: u16) {
        let Ends { v0, v1, .. } = collapse.ends;
        let Self { vertices, model, edge_ring, queue, .. } = self;
        let gone =
            [0, edge_ring.of_v0].iter().filter(|&&wing| edge_ring.ghost != Some(wing)).count();
        self.live_faces -= gone;
        if let Some(components) = &mut self.components {
            components.lose(v0, gone);
        }
        let constraints = model.apply(vertices, edge_ring, collapse);
        let mut merged = A::Metric::merged_quadric(vertices, edge_ring, quadric, collapse);
        merged.star.add(&constraints);
        let (first, second) = edge_ring.dying_normals();
        let mut last = edge_ring.changes[edge_ring.len - 1];
        for i in 0..edge_ring.len {
            let change = edge_ring.changes[i];
            let id = edge_ring.ids[i];
            if id != GHOST {
                let vertex = vertices.get_mut(id);
                A::Metric::update_neighbour(vertex, [&last, &change], v0);
                let mut woken = vertex.floor > 0;
                if i == 0 || i == edge_ring.of_v0 {
                    A::Metric::remove_face(vertex, if i == 0 { first } else { second });
                    woken |= vertex.remove_neighbour(v1);
                } else if i > edge_ring.of_v0 {
                    vertex.replace_neighbour(v1, v0);
                }
                if woken {
                    queue.wake(vertex, id, front);
                }
            }
            last = change;
        }
        let gone = vertices.get_mut(v1);
        gone.flags.set(VertexFlags::DEAD);
        gone.target = v0;
        let protected = gone.flags.0 & VertexFlags::PROTECTED.0;
        vertices.set_ring_of(v0, &edge_ring.ids, edge_ring.len);
        let kept = vertices.get_mut(v0);
        kept.put(collapse.place, merged);
        kept.moved = moved;
        kept.flags.set(VertexFlags(protected));
        kept.floor = 0;
    }
}

/// Rounds a place to floats. If the metric preserves the volume, which drives vertices out, also
/// moves it into the box of half the size `room`.
#[inline(always)]
pub(crate) fn within<M: Metric>(room: Vec3, place: DVec3) -> Vec3 {
    match M::METHOD.conserves_volume() {
        true => place.as_vec3().clamp(-room, room),
        false => place.as_vec3(),
    }
}

/// Returns true if a place is as near to the surface as the best one, and to the plane of equal
/// volume.
fn is_as_good(aim: &EdgeQuadricF64, place: DVec3, best: DVec3) -> bool {
    let &EdgeQuadricF64 { half, normal, level, .. } = aim;
    let off = level - normal.dot(place);
    aim.at(place) <= aim.at(best) + AS_GOOD * aim.weight() * half.length_squared()
        && off * off <= AS_GOOD * normal.length_squared() * half.length_squared()
}

/// SIMD task of [`CollapseLoop::run`].
struct ContractAll<'e, 'v, A> {
    collapse_loop: &'e mut CollapseLoop<'v, A>,
    faces: usize,
    last: u16,
}

impl<A: AttributeModel> SimdTask for ContractAll<'_, '_, A> {
    type Output = ();

    #[inline(always)]
    fn work(self) {
        self.collapse_loop.contract_all(self.faces, self.last);
    }
}
