//! The surface in parts that coarsen side by side, at one common cost.
//!
//! A part is a run of the vertices. Vertices with neighbours in another part wait; all others are
//! contracted as if their part were alone, which in memory it is. All parts go on to the same cost
//! before any goes further, so they coarsen evenly. When the borders weigh too much, a few parts at
//! a time are merged and the next round begins, until one is left.
//!
//! The parts, and how far each goes, depend on the surface alone: the result is the same for any
//! number of threads.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use crate::kernel::attributes::{AttributeModel, AttributeStore};
use crate::kernel::bound::ErrorBound;
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::collapse_loop::{CollapseLoop, are_parts_stuck, is_seen};
use crate::kernel::components::Components;
use crate::kernel::contraction_log::Steps;
use crate::kernel::handles::Handles;
use crate::kernel::mesh::one_ring::{GHOST, LongRing, VertexStore, Vertices};
use crate::kernel::mesh::vertex::VertexFlags;
use crate::kernel::retrace::Retrace;
use crate::kernel::schedule::bucket_queue::{BucketQueue, last_bucket};
use crate::kernel::schedule::deferral::Deferral;
use crate::kernel::volume::{VolumeDebts, VolumeTally};
use crate::refusal::Refusals;
use crate::surface::ties::Ties;

/// Largest number of vertices of a part in the first round: 6 MB of records. Smaller meshes are one
/// part: in four parts of 12,000, horse-97k has .00734 and .0583 at 10 % and 1 % instead of .00722
/// and .0571.
const MAX_PART: usize = 3 << 14;

/// Number of parts merged into one.
const MERGED_PARTS: usize = 4;

/// A round ends when there are no more than this many faces for each waiting vertex.
///
/// Mean error of the dragon at 1 %, which has .0238 in one part: 3 .02378, 5 .02364, 10 .02371. On
/// the way to zero faces every level counts; igea's at 15 and 10 %, and armadillo-173k's at 10 and
/// 5 %: 5 .00400, .00566, .0165, .0242; 10 .00364, .00462, .0128, .0236; 20 .00350, .00461, .0128,
/// .0237, with less done in parts.
const FACES_PER_WAITING: usize = 10;

/// Number of faces beyond the target that a round leaves for each waiting vertex: by then their
/// edges are cheap, and must go before the target is reached. Mean error of the dragon at 10 %,
/// which has .00264 in one part: 0 .00293, 2, 3 and 4 .00266.
const FACES_LEFT_PER_WAITING: usize = 2;

/// A step ends at the cost at which the queues have entries for this fraction, 1/4, of the faces to
/// remove.
const STEP_FRACTION: usize = 4;

/// Up to this many faces to remove per part, the parts run one after the other.
const SERIAL_FACES_PER_PART: usize = 4;

/// Number of faces removed from a surface of one part between two progress reports.
const FACES_PER_REPORT: usize = 8192;

/// Constraints of the whole surface.
pub(crate) struct Whole {
    /// Ties, if there are any. They need the surface in one part.
    pub(crate) ties: Option<Ties>,
    /// Components that may vanish once the surface is in one part, if there are any.
    pub(crate) components: Option<Components>,
    /// Handles that may close once the surface is in one part, if there are any.
    pub(crate) handles: Option<Handles>,
    /// Half the size of the input's box, centred in the frame and a little larger. A metric that
    /// preserves the volume keeps all vertices in it.
    pub(crate) room: Vec3,
}

impl Default for Whole {
    fn default() -> Self {
        Self { ties: None, components: None, handles: None, room: Vec3::INFINITY }
    }
}

/// A surface in parts.
pub(crate) struct Partition<S> {
    pub(crate) store: VertexStore,
    pub(crate) attributes: S,
    pub(crate) live_faces: usize,
    /// Square of the largest error estimate so far, in the frame's units.
    pub(crate) error: f64,
    /// Number of edges contracted.
    pub(crate) contractions: usize,
    pub(crate) refusals: Refusals,
    pub(crate) volume: VolumeTally,
    pub(crate) whole: Whole,
    /// Long rings of copies, which are in no part until all vertices are in one.
    long_of_copies: Vec<LongRing>,
    /// Steps done so far, if an observer wants them.
    pub(crate) log: Option<Steps>,
    /// True if an observer also wants the values of attributes.
    pub(crate) records_values: bool,
    parts: Vec<PartState>,
}

/// State of a part that is kept between rounds.
struct PartState {
    vertices: Range<usize>,
    queue: BucketQueue,
    long: Vec<LongRing>,
    /// Working memory, allocated once, since simplification may go on step by step.
    edge_ring: Box<EdgeRing>,
    deferral: Deferral,
    debts: VolumeDebts,
    /// Vertices with neighbours in other parts.
    waiting: Vec<u32>,
}

impl<S: AttributeStore> Partition<S> {
    pub(crate) fn new(store: VertexStore, attributes: S, live_faces: usize, whole: Whole) -> Self {
        let are_many = whole.components.as_ref().is_some_and(|all| all.are_many(live_faces));
        let part = if whole.ties.is_some() || are_many { usize::MAX } else { MAX_PART };
        let mut this = Self { whole, ..Self::of_at_most(part, store, attributes, live_faces) };
        if this.parts.len() > 1 {
            this.whole.components.iter_mut().for_each(Components::lose_count);
        }
        this
    }

    /// Splits the surface into parts of at most `part` vertices.
    pub(in crate::kernel) fn of_at_most(
        part: usize,
        mut store: VertexStore,
        attributes: S,
        live_faces: usize,
    ) -> Self {
        let mut count = 1;
        while store.own().div_ceil(count) > part {
            count *= MERGED_PARTS;
        }
        let long = std::mem::take(&mut store.long);
        let mut partition = Self {
            parts: cut(&store, count),
            store,
            attributes,
            live_faces,
            error: 0.0,
            contractions: 0,
            refusals: Refusals::default(),
            volume: VolumeTally::default(),
            whole: Whole::default(),
            long_of_copies: Vec::new(),
            log: None,
            records_values: false,
        };
        partition.hand_out(long);
        partition.cut_attributes();
        partition.cost_all_vertices();
        partition
    }

    /// Costs all vertices for the first time, except those that wait.
    fn cost_all_vertices(&mut self) {
        self.loops().into_par_iter().for_each(|(mut collapse_loop, waiting)| {
            let vertices = &mut collapse_loop.vertices;
            waiting.extend(vertices.ids().filter(|&v| has_far_neighbours(vertices, v)));
            for &v in &*waiting {
                vertices.get_mut(v).flags.set(VertexFlags::OUTER);
            }
            collapse_loop.cost_all_vertices();
        });
    }

    /// Contracts until at most `faces` are left, or all costs are in buckets behind `last`, or no
    /// further contraction is possible. Reports progress as numbers of removed faces.
    pub(crate) fn run(
        &mut self,
        faces: usize,
        last: u16,
        mut bound: Option<&mut ErrorBound<'_>>,
        gone: &mut dyn FnMut(usize),
    ) {
        loop {
            self.round(faces, last, bound.as_deref_mut(), gone);
            if self.live_faces <= faces || self.parts.len() == 1 {
                return;
            }
            self.merge_parts();
        }
    }

    /// Ends the simplification. Returns what a log needs to be understood: the copies of vertices,
    /// without the vertices, and the components.
    pub(crate) fn without_vertices(self) -> (VertexStore, Whole) {
        let Self { mut store, whole, .. } = self;
        store.all = Vec::new();
        (store, whole)
    }

    /// Returns the bucket of the next step. The surface must be one part.
    pub(crate) fn next_bucket(&mut self) -> Option<u16> {
        self.loops().iter_mut().filter_map(|(collapse_loop, _)| collapse_loop.next_bucket()).min()
    }

    /// Makes all refused edges eligible again.
    pub(crate) fn wake_all(&mut self) {
        self.loops().into_par_iter().for_each(|(mut collapse_loop, _)| collapse_loop.wake_all());
    }

    /// Returns the vertices that owe volume, and how much, six times, in the frame.
    pub(crate) fn debts(&self) -> Vec<(u32, f64)> {
        let of_part = |part: &PartState| {
            let base = part.vertices.start;
            part.debts.all().map(move |(v, debt)| ((base + v) as u32, debt)).collect::<Vec<_>>()
        };
        self.parts.iter().flat_map(of_part).collect()
    }

    /// Returns true if most of several components can go no further, and the surface has moved far.
    ///
    /// Cost: O(n), n = vertices, where it has moved far, and O(1) elsewhere.
    pub(crate) fn is_near_limit(&mut self) -> bool {
        // Twice as far as any step may go: scans with many handles that stay are farther off than once.
        let is_far = self.parts.len() == 1 && is_seen(self.error as f32 / 4.0, self.whole.room);
        let are_stuck = |collapse_loop: &mut CollapseLoop<'_, S::Part<'_>>| {
            are_parts_stuck(&mut collapse_loop.vertices)
        };
        is_far && self.loops().first_mut().is_some_and(|(whole, _)| are_stuck(whole))
    }

    /// Merges all parts into one.
    pub(crate) fn unite(&mut self) {
        while self.parts.len() > 1 {
            self.merge_parts();
        }
    }

    /// Contracts to this number of faces, or until the borders weigh too much.
    fn round(
        &mut self,
        faces: usize,
        last: u16,
        bound: Option<&mut ErrorBound<'_>>,
        gone: &mut dyn FnMut(usize),
    ) {
        let waiting: usize = self.parts.iter().map(|part| part.waiting.len()).sum();
        let stop = (faces + FACES_LEFT_PER_WAITING * waiting).max(FACES_PER_WAITING * waiting);
        let mut live = self.live_faces;
        let mut log = self.log.take();
        let mut loops: Vec<CollapseLoop<'_, S::Part<'_>>> =
            self.loops().into_iter().map(|(collapse_loop, _)| collapse_loop).collect();
        if let Some(bound) = bound {
            let lengths: Vec<usize> = loops.iter().map(|e| e.vertices.all.len()).collect();
            let all = bound.split(&lengths);
            loops.iter_mut().zip(all).for_each(|(collapse_loop, part)| {
                // An error of positions does not see what is lost where seams give way.
                collapse_loop.hold_seams();
                collapse_loop.within = Some(part);
            });
        }
        while live > stop {
            let Some(step) = CostStep::new(&loops, live - stop, last) else { break };
            let before = live;
            if let Some(log) = &mut log {
                loops.iter_mut().for_each(|collapse_loop| collapse_loop.log = Some(Vec::new()));
                live = step.run(&mut loops, live, stop);
                log.append(loops.iter_mut().map(take_steps));
            } else {
                live = step.run(&mut loops, live, stop);
            }
            gone(before - live);
        }
        let done: Vec<Done> = loops.iter().map(Done::of).collect();
        drop(loops);
        done.iter().for_each(|done| self.add(done));
        self.live_faces = live;
        self.log = log;
    }

    /// Repeats the steps of another run without some of them, on the unchanged surface.
    pub(crate) fn retrace(&mut self, retrace: &Retrace) {
        self.unite();
        let (live_faces, log) = (self.live_faces, self.log.take());
        let mut loops = self.loops();
        let Some((collapse_loop, _)) = loops.first_mut() else { return };
        collapse_loop.live_faces = live_faces;
        collapse_loop.log = log.map(|steps| steps.log);
        let is_logged = collapse_loop.log.is_some();
        collapse_loop.retrace(retrace);
        let (done, live_faces) = (Done::of(collapse_loop), collapse_loop.live_faces);
        let log = is_logged.then(|| take_steps(collapse_loop));
        drop(loops);
        self.add(&done);
        (self.live_faces, self.log) = (live_faces, log);
        self.refusals += retrace.refusals;
        self.parts.iter_mut().for_each(|part| part.deferral.merge(&retrace.deferral));
    }

    /// Returns what is usual at the front, joined over all parts.
    pub(crate) fn deferral(&self) -> Deferral {
        let mut all = Deferral::default();
        self.parts.iter().for_each(|part| all.merge(&part.deferral));
        all
    }

    fn add(&mut self, done: &Done) {
        self.contractions += done.contractions;
        self.error = self.error.max(done.error);
        self.refusals += done.refusals;
        self.volume.merge(&done.volume);
    }

    /// Merges groups of parts. Vertices that need not wait any more are queued.
    fn merge_parts(&mut self) {
        let mut parts = std::mem::take(&mut self.parts);
        self.parts = cut(&self.store, parts.len() / MERGED_PARTS);
        let mut lists: Vec<Vec<_>> = Vec::new();
        for (joined, parts) in self.parts.iter_mut().zip(parts.chunks_mut(MERGED_PARTS)) {
            let mut len = 0;
            for part in &mut *parts {
                joined.debts.append(len, std::mem::take(&mut part.debts), part.vertices.len());
                len += part.vertices.len();
                joined.queue.append(std::mem::take(&mut part.queue));
                joined.waiting.append(&mut part.waiting);
                joined.deferral.merge(&part.deferral);
            }
            lists.push(parts.iter_mut().map(|part| std::mem::take(&mut part.long)).collect());
        }
        if let [lists] = &mut lists[..] {
            lists.push(std::mem::take(&mut self.long_of_copies));
        }
        self.cut_attributes();
        let work = self.loops().into_par_iter().zip(lists);
        work.for_each(|((mut collapse_loop, waiting), lists): (_, Vec<_>)| {
            lists.into_iter().for_each(|lists| collapse_loop.vertices.adopt(lists));
            let all = std::mem::take(waiting);
            for v in all {
                if has_far_neighbours(&collapse_loop.vertices, v) {
                    waiting.push(v);
                } else {
                    collapse_loop.release(v);
                }
            }
        });
    }

    /// Returns a loop for each part, with the part's waiting vertices.
    fn loops(&mut self) -> Vec<(CollapseLoop<'_, S::Part<'_>>, &mut Vec<u32>)> {
        let first_copy = self.store.first_copy();
        let (error, room, records_values) = (self.error, self.whole.room, self.records_values);
        let VertexStore { all, copied, split, protection, .. } = &mut self.store;
        let mut rest = &mut all[..];
        let mut loops = Vec::with_capacity(self.parts.len());
        let models = self.attributes.parts(self.parts.len());
        for (part, model) in self.parts.iter_mut().zip(models) {
            let PartState { vertices, queue, long, edge_ring, deferral, debts, waiting } = part;
            let (all, others) = rest.split_at_mut(vertices.len());
            rest = others;
            let base = vertices.start as u32;
            let protection = *protection;
            let vertices = Vertices { all, base, long, copied, split, first_copy, protection };
            let mut collapse_loop =
                CollapseLoop::new(vertices, model, queue, edge_ring, (deferral, debts), room);
            collapse_loop.error = error;
            collapse_loop.records_values = records_values;
            loops.push((collapse_loop, waiting));
        }
        if let [(collapse_loop, _)] = &mut loops[..] {
            collapse_loop.ties = self.whole.ties.as_mut();
            collapse_loop.components = self.whole.components.as_mut();
            collapse_loop.handles = self.whole.handles.as_mut();
        }
        loops
    }

    /// Cuts the attributes like the vertices.
    fn cut_attributes(&mut self) {
        let ranges: Vec<_> = self.parts.iter().map(|part| part.vertices.clone()).collect();
        self.attributes.cut(&ranges);
    }

    /// Gives the long rings to the parts of their vertices.
    fn hand_out(&mut self, long: Vec<LongRing>) {
        let mut parts = self.parts.iter_mut().peekable();
        for list in long {
            while parts.next_if(|part| part.vertices.end <= list.of as usize).is_some() {}
            let lists = match parts.peek_mut() {
                Some(part) => &mut part.long,
                None => &mut self.long_of_copies,
            };
            self.store.all[list.of as usize].ring[0] = lists.len() as u32;
            lists.push(list);
        }
    }
}

/// Cuts the vertices into parts of equal size. A single part has all vertices, several have no
/// copies: the neighbours of copies wait.
fn cut(store: &VertexStore, count: usize) -> Vec<PartState> {
    let whole = if count == 1 { store.all.len() } else { store.own() };
    let part = |i: usize| PartState {
        vertices: whole * i / count..whole * (i + 1) / count,
        queue: BucketQueue::default(),
        long: Vec::new(),
        edge_ring: Box::new(EdgeRing::new(store.boundary_weight)),
        deferral: Deferral::default(),
        debts: VolumeDebts::default(),
        waiting: Vec::new(),
    };
    (0..count).map(part).collect()
}

fn has_far_neighbours(vertices: &Vertices, v: u32) -> bool {
    let ids = vertices.ids();
    vertices.neighbours(v).iter().any(|w| *w != GHOST && !ids.contains(w))
}

/// Takes the steps that a loop has done since its log was begun.
fn take_steps<A: AttributeModel>(collapse_loop: &mut CollapseLoop<'_, A>) -> Steps {
    let log = collapse_loop.log.take().unwrap_or_default();
    Steps { log, values: collapse_loop.model.recorded() }
}

/// Counts and totals of the work of a loop.
struct Done {
    error: f64,
    contractions: usize,
    refusals: Refusals,
    volume: VolumeTally,
}

impl Done {
    fn of<A: AttributeModel>(of: &CollapseLoop<'_, A>) -> Self {
        let &CollapseLoop { error, contractions, refusals, volume, .. } = of;
        Self { error, contractions, refusals, volume }
    }
}

/// Limit up to which all parts go before any goes further.
struct CostStep {
    /// The last bucket.
    last: u16,
    /// Largest number of faces that each of several parts may lose.
    shares: Vec<usize>,
}

impl CostStep {
    /// Plans the next step up to the bucket `last`, which removes at most `excess` faces; `None` if
    /// no part has anything to do.
    fn new<A: AttributeModel>(
        loops: &[CollapseLoop<'_, A>],
        excess: usize,
        last: u16,
    ) -> Option<Self> {
        if let [collapse_loop] = loops {
            let is_idle = collapse_loop.lowest_bucket() > usize::from(last.min(last_bucket()));
            return (!is_idle).then(|| Self { last, shares: Vec::new() });
        }
        let mut entries = vec![0; usize::from(last.min(last_bucket())) + 1];
        for collapse_loop in loops {
            entries
                .iter_mut()
                .zip(collapse_loop.queue.lengths())
                .for_each(|(sum, more)| *sum += more);
        }
        let (mut total, mut until) = (0, None);
        for (bucket, &more) in entries.iter().enumerate().filter(|(_, more)| **more > 0) {
            (total, until) = (total + more, Some(bucket));
            if total > excess / STEP_FRACTION {
                break;
            }
        }
        let until = until?;
        let own = |collapse_loop: &CollapseLoop<'_, A>| {
            collapse_loop.queue.lengths().take(until + 1).sum::<usize>()
        };
        let share =
            |collapse_loop| (excess as u64 * own(collapse_loop) as u64 / total as u64) as usize;
        let shares = loops.iter().map(share).collect();
        Some(Self { last: until as u16, shares })
    }

    /// Carries out the step from `live` faces, but not below `stop`. Returns the number of faces
    /// left.
    fn run<A: AttributeModel>(
        &self,
        loops: &mut [CollapseLoop<'_, A>],
        live: usize,
        stop: usize,
    ) -> usize {
        if let [collapse_loop] = loops {
            let stop = stop.max(live.saturating_sub(FACES_PER_REPORT));
            if collapse_loop.within.is_none() {
                return run(collapse_loop, live, stop, self.last);
            }
            // Where other threads help, the loop is one of them.
            return rayon::scope(|_| run(collapse_loop, live, stop, self.last));
        }
        if live - stop <= loops.len() * SERIAL_FACES_PER_PART {
            let loops = loops.iter_mut();
            return loops
                .fold(live, |live, collapse_loop| run(collapse_loop, live, stop, self.last));
        }
        let gone = loops.par_iter_mut().zip(&self.shares).map(|(collapse_loop, share)| {
            // The last contraction may remove one face more.
            live - run(collapse_loop, live, live - share.saturating_sub(1), self.last)
        });
        live - gone.sum::<usize>()
    }
}

/// Runs one part until `stop` of all `live` faces are left. Returns the number of faces left.
fn run<A: AttributeModel>(
    collapse_loop: &mut CollapseLoop<'_, A>,
    live: usize,
    stop: usize,
    last: u16,
) -> usize {
    collapse_loop.live_faces = live;
    collapse_loop.run(stop, last);
    collapse_loop.live_faces
}

#[cfg(test)]
mod tests;
