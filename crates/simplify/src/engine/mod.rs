//! Policy engine: contracts the cheapest candidate that passes all checks, then updates costs.
//!
//! Costs are updated lazily. A candidate whose vertices have changed since it was costed is costed
//! again only when it reaches the front of the queue. As long as contractions can only raise costs,
//! this gives the order of eager updates with about half the evaluations. A refused candidate is
//! parked until the neighbourhood of one of its vertices changes.

pub(crate) mod candidates;
pub(crate) mod checks;
pub(crate) mod estimate;
pub(crate) mod locks;
pub(crate) mod policy;
pub(crate) mod prepared_surface;
pub(crate) mod queue;
mod tied;
mod vanish;
pub(crate) mod vanishing;
mod waiting;

use meshlod_mesh::VertexId;
use rayon::prelude::*;

use self::waiting::{SurfaceCandidates, Waiting};
use crate::engine::checks::{flip, topology};
use crate::engine::estimate::estimate;
use crate::engine::policy::{Candidates, Memory, Observe, Placement, Priority, Stop};
use crate::engine::prepared_surface::PreparedSurface;
use crate::engine::queue::{Entry, Key};
use crate::engine::vanishing::Vanishing;
use crate::history::volume::VolumeLoss;
use crate::options::Contractions;
use crate::refusal::{Refusal, Refusals};
use crate::run::{Run, Tally};
use crate::surface::candidate_states::CandidateId;
use crate::surface::candidate_states::State;
use crate::surface::contracted::{Contracted, Freedom};
use crate::surface::neighbourhood::{Neighbourhood, freedom};
use crate::surface::{Flags, Placed, Surface};

/// Simplification algorithm, as a choice of policies. Limits and observer are passed with each run.
pub(crate) struct Algorithm<C, M, P, L> {
    pub(crate) candidates: C,
    pub(crate) memory: M,
    pub(crate) priority: P,
    pub(crate) placement: L,
}

/// Algorithm running on a surface.
pub(crate) struct Engine<C, M, P, L> {
    algorithm: Algorithm<C, M, P, L>,
    surface: Surface,
    neighbourhood: Neighbourhood,
    /// Scratch space for an edge of a contracted face.
    part: Neighbourhood,
    /// Scratch space for the edges that ties contract together with one.
    tied: Vec<Neighbourhood>,
    waiting: Waiting,
    vanishing: Vanishing,
    /// Number of components that have vanished.
    vanished: usize,
    contractions: Contractions,
    /// Scratch space for the candidates that a contraction opens.
    opened: Vec<CandidateId>,
    /// Scratch space for the entries of a bucket.
    taken: Vec<(Entry, Contracted)>,
    refusals: Refusals,
    error_estimate: f64,
    volume: VolumeLoss,
    /// Smallest error bound that has refused a candidate since all candidates were last retried.
    refused_above: f64,
}

impl<C, M, P, L> Engine<C, M, P, L>
where
    C: Candidates,
    M: Memory,
    P: Priority<M>,
    L: Placement<M>,
{
    fn new(algorithm: Algorithm<C, M, P, L>, ready: PreparedSurface) -> Self {
        let PreparedSurface { mut surface, connectivity, vanishing } = ready;
        let seeds = algorithm.candidates.seed(&surface, &connectivity);
        // Frees its memory before the queue is allocated.
        drop(connectivity);
        let entries: Vec<Entry> =
            seeds.into_par_iter().map(|id| algorithm.entry(&surface, id)).collect();
        let waiting = Waiting::new(&entries, &mut surface);
        Self {
            algorithm,
            surface,
            neighbourhood: Neighbourhood::default(),
            part: Neighbourhood::default(),
            tied: Vec::new(),
            waiting,
            vanishing,
            vanished: 0,
            contractions: Contractions::default(),
            opened: Vec::new(),
            taken: Vec::new(),
            refusals: Refusals::default(),
            error_estimate: 0.0,
            volume: VolumeLoss::default(),
            refused_above: f64::INFINITY,
        }
    }

    /// Requeues all parked candidates if a smaller error bound than this has refused any.
    #[inline]
    fn retry_within(&mut self, error: f64) {
        if error > self.refused_above {
            self.refused_above = f64::INFINITY;
            self.waiting.wake_all(&mut self.surface);
            self.vanishing.wake_all();
        }
    }

    /// Takes the cheapest candidate off the queue, with its cost up to date.
    fn next_up_to_date(&mut self) -> Option<Entry> {
        loop {
            let Some(entry) = self.waiting.queue.pop() else {
                let bucket = self.waiting.queue.next_bucket()?;
                self.refresh_bucket(bucket);
                continue;
            };
            if let Some(vertices) = self.take(entry) {
                let entry = self.refresh(entry, &vertices);
                if self.waiting.queue.peek().is_none_or(|next| entry <= next) {
                    return Some(entry);
                }
                self.waiting.put(entry, &mut self.surface);
            }
        }
    }

    /// Costs the stale entries of a bucket again in loops of independent loads. One by one between
    /// contractions, each would cost a memory latency.
    fn refresh_bucket(&mut self, bucket: Vec<Entry>) {
        let mut taken = std::mem::take(&mut self.taken);
        taken.extend(bucket.into_iter().filter_map(|entry| Some((entry, self.take(entry)?))));
        for (entry, vertices) in taken.drain(..) {
            let entry = self.refresh(entry, &vertices);
            self.waiting.put(entry, &mut self.surface);
        }
        self.taken = taken;
    }

    /// Returns the vertices of an entry that has left the queue, or `None` if its candidate is
    /// closed.
    #[inline]
    fn take(&mut self, entry: Entry) -> Option<Contracted> {
        let state = self.surface.state(entry.id);
        if matches!(state, State::Queued | State::Ghost) {
            self.surface.set_state(entry.id, State::Closed);
        }
        (state == State::Queued)
            .then(|| self.algorithm.candidates.vertices(&self.surface, entry.id))
    }

    /// Returns the entry, costed again if its vertices have changed.
    #[inline]
    fn refresh(&self, entry: Entry, vertices: &Contracted) -> Entry {
        if entry.stamp == self.surface.stamp(vertices) {
            return entry;
        }
        self.algorithm.entry(&self.surface, entry.id)
    }

    fn contract(
        &mut self,
        entry: Entry,
        stop: &Stop,
        observer: &mut dyn Observe,
    ) -> Result<(), Refusal> {
        let Self { algorithm, surface, neighbourhood, .. } = self;
        let contracted = algorithm.candidates.vertices(surface, entry.id);
        neighbourhood.gather(surface, contracted)?;
        topology(surface, neighbourhood)?;
        if !neighbourhood.partners.is_empty() {
            return self.contract_tied(stop, observer);
        }
        let mut placed = algorithm.placement.place(surface, &algorithm.memory, neighbourhood)?;
        placed.error_estimate = estimate(surface, neighbourhood, &placed);
        if placed.error_estimate > stop.error {
            return Err(Refusal::Error);
        }
        flip(surface, neighbourhood, placed.position)?;
        self.apply(&placed, observer);
        Ok(())
    }

    /// Contracts the gathered candidate and updates memory, candidates and error.
    fn apply(&mut self, placed: &Placed, observer: &mut dyn Observe) {
        let Self { algorithm, surface, neighbourhood, part, contractions, volume, .. } = self;
        let observer = &mut (volume, observer);
        algorithm.memory.merge(surface, neighbourhood, placed);
        match neighbourhood.contracted[..] {
            [_, _] => {
                contractions.edges += 1;
                contract_edge(surface, neighbourhood, placed, observer);
            }
            _ => {
                contractions.faces += 1;
                contract_face(surface, neighbourhood, part, placed, observer);
            }
        }
        algorithm.memory.renew(surface, neighbourhood, placed);
        if M::KNOWS_RING {
            neighbourhood.ring.iter().for_each(|r| surface.touch(r.id));
        }
        self.error_estimate = self.error_estimate.max(placed.error_estimate);
        self.update_candidates(placed);
    }

    /// Opens the alternatives to a refused candidate.
    fn open_alternatives(&mut self, entry: Entry) {
        let Self { algorithm, surface, opened, .. } = self;
        algorithm.candidates.refused(entry.id, &mut SurfaceCandidates { surface, opened });
        self.enqueue_opened();
    }

    /// Puts the newly opened candidates in the queue.
    fn enqueue_opened(&mut self) {
        let Self { algorithm, surface, waiting, opened, .. } = self;
        for id in opened.drain(..) {
            let entry = algorithm.entry(surface, id);
            waiting.put(entry, surface);
        }
    }

    /// Updates the candidates after a contraction, and wakes those parked at the vertices around.
    fn update_candidates(&mut self, placed: &Placed) {
        let Self { algorithm, surface, neighbourhood, opened, .. } = self;
        let kept = neighbourhood.contracted[placed.kept];
        algorithm.candidates.update(
            neighbourhood,
            kept,
            &mut SurfaceCandidates { surface, opened },
        );
        self.enqueue_opened();
        let Self { surface, neighbourhood, waiting, .. } = self;
        for v in
            neighbourhood.contracted.iter().copied().chain(neighbourhood.ring.iter().map(|r| r.id))
        {
            let flags = surface.flags(v);
            if flags.any(Flags::AWAITED) {
                waiting.wake(v, surface);
            }
            if flags.any(Flags::TIED) {
                waiting.wake_tied(v, surface);
            }
        }
        // The kept vertex has the flags of all contracted ones, and their parked candidates are
        // awake.
        surface.unflag(kept, Flags::AWAITED);
    }
}

/// Contracts the gathered edge and notifies the observer.
fn contract_edge(
    surface: &mut Surface,
    neighbourhood: &Neighbourhood,
    placed: &Placed,
    observer: &mut dyn Observe,
) {
    observer.before(surface, neighbourhood, placed);
    surface.contract(neighbourhood, placed);
    observer.after(surface, neighbourhood, placed);
    observer.gone(neighbourhood.removed_faces.len());
}

/// Contracts a face as two edges: its other corners are merged into the kept one in turn. Wedges,
/// the history and all observers therefore handle edges only.
fn contract_face(
    surface: &mut Surface,
    neighbourhood: &Neighbourhood,
    part: &mut Neighbourhood,
    placed: &Placed,
    observer: &mut dyn Observe,
) {
    let kept = neighbourhood.contracted[placed.kept];
    observer.face();
    for &gone in neighbourhood.contracted.iter().filter(|&&v| v != kept) {
        part.gather(surface, Contracted::edge([kept, gone]))
            .expect("a face that may be contracted can be contracted edge by edge");
        if surface.position(kept) == placed.position && part.freedom == Freedom::AlongNormal(0) {
            // The kept vertex has been moved along its normal by the first edge.
            part.freedom = Freedom::Free;
        }
        contract_edge(surface, part, &Placed { kept: 0, ..*placed }, observer);
    }
}

impl<C, M, P, L> Run for Engine<C, M, P, L>
where
    C: Candidates,
    M: Memory,
    P: Priority<M>,
    L: Placement<M>,
{
    fn run(&mut self, stop: &Stop, observer: &mut dyn Observe) {
        while self.surface.live_faces() > stop.faces && self.step(stop, observer) {}
    }

    fn step(&mut self, stop: &Stop, observer: &mut dyn Observe) -> bool {
        self.retry_within(stop.error);
        loop {
            let next = self.next_up_to_date();
            let most = next.map_or(f64::INFINITY, |entry| entry.key.cost()).min(stop.cost);
            if let Some(component) = self.vanishing.take_up_to(most) {
                next.into_iter().for_each(|entry| self.waiting.put(entry, &mut self.surface));
                if self.vanish(component, stop, observer) {
                    return true;
                }
                continue;
            }
            let Some(entry) = next else { return false };
            if entry.key.cost() > stop.cost {
                self.waiting.put(entry, &mut self.surface);
                return false;
            }
            match self.contract(entry, stop, observer) {
                Ok(()) => return true,
                Err(refusal) => {
                    self.refusals.add(refusal);
                    let vertices = self.algorithm.candidates.vertices(&self.surface, entry.id);
                    self.waiting.park(entry, &vertices, &mut self.surface);
                    self.open_alternatives(entry);
                    if refusal == Refusal::Error {
                        self.refused_above = self.refused_above.min(stop.error);
                    }
                }
            }
        }
    }

    fn next_cost(&mut self) -> Option<f64> {
        self.retry_within(f64::INFINITY);
        let next = self.next_up_to_date();
        next.into_iter().for_each(|entry| self.waiting.put(entry, &mut self.surface));
        let costs =
            next.map(|entry| entry.key.cost()).into_iter().chain(self.vanishing.next_cost());
        costs.min_by(f64::total_cmp)
    }

    fn surface(&self) -> &Surface {
        &self.surface
    }

    fn into_surface(self: Box<Self>) -> Surface {
        self.surface
    }

    fn live_faces(&self) -> usize {
        self.surface.live_faces()
    }

    fn tally(&self) -> Tally {
        let &Self { vanished, contractions, refusals, error_estimate, volume, .. } = self;
        let (handles, near_limit) = (None, false);
        Tally { vanished, handles, contractions, refusals, error_estimate, near_limit, volume }
    }
}

impl<C, M, P, L> Algorithm<C, M, P, L>
where
    C: Candidates + 'static,
    M: Memory + 'static,
    P: Priority<M> + 'static,
    L: Placement<M> + 'static,
{
    /// Starts the algorithm on a prepared surface.
    pub(crate) fn start(self, ready: PreparedSurface) -> Box<dyn Run> {
        Box::new(Engine::new(self, ready))
    }
}

impl<C: Candidates, M, P: Priority<M>, L> Algorithm<C, M, P, L> {
    /// Builds a queue entry with the current cost. A candidate that may never be contracted gets an
    /// infinite cost, goes last and is refused there.
    #[inline]
    fn entry(&self, surface: &Surface, id: CandidateId) -> Entry {
        let contracted = self.candidates.vertices(surface, id);
        let cost = self.cost(surface, &contracted).unwrap_or(f64::INFINITY);
        Entry { key: Key::new(cost), id, stamp: surface.stamp(&contracted) }
    }

    #[inline]
    fn cost(&self, surface: &Surface, contracted: &Contracted) -> Option<f64> {
        let special = |&v: &VertexId| surface.flags(v).any(SPECIAL);
        if contracted.iter().any(special) {
            return self.special_cost(surface, contracted);
        }
        self.priority.cost(surface, &self.memory, contracted, Freedom::Free)
    }

    /// Returns the cost of a candidate with special vertices: the sum over all edges contracted
    /// with it.
    fn special_cost(&self, surface: &Surface, contracted: &Contracted) -> Option<f64> {
        if surface.is_crowded(contracted) {
            return None;
        }
        let mut partners = Vec::new();
        let mut freedom = freedom(surface, contracted, &mut Vec::new(), &mut partners).ok()?;
        for &edge in &partners {
            freedom = freedom.and(freedom_of_partner(surface, edge)?)?;
        }
        let cost = |of: &Contracted| self.priority.cost(surface, &self.memory, of, freedom);
        let add = |sum: f64, &edge: &[VertexId; 2]| Some(sum + cost(&Contracted::edge(edge))?);
        let cost = partners.iter().try_fold(cost(contracted)?, add)?;
        let is_protected = |&v: &VertexId| surface.flags(v).any(Flags::PROTECTED);
        let protected = contracted.iter().chain(partners.iter().flatten()).any(is_protected);
        Some(if protected { cost * surface.protection } else { cost })
    }
}

/// Flags of vertices whose contractions cost more than the method's own cost of a free one.
const SPECIAL: Flags = Flags::PINNED.or(Flags::SEAM).or(Flags::TIED).or(Flags::PROTECTED);

fn freedom_of_partner(surface: &Surface, edge: [VertexId; 2]) -> Option<Freedom> {
    freedom(surface, &Contracted::edge(edge), &mut Vec::new(), &mut Vec::new()).ok()
}
