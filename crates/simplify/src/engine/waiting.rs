//! Candidates open for contraction, and their states as a [`Candidates`](super::policy::Candidates)
//! policy updates them.

use meshlod_mesh::VertexId;
use rustc_hash::FxHashMap;

use crate::engine::policy::CandidateSink;
use crate::engine::queue::{Entry, Queue};
use crate::surface::candidate_states::CandidateId;
use crate::surface::candidate_states::State;
use crate::surface::{Flags, Surface};

/// Candidates open for contraction: queued, or parked until their neighbourhood changes.
pub(super) struct Waiting {
    pub(super) queue: Queue,
    parked: FxHashMap<VertexId, Vec<Entry>>,
}

impl Waiting {
    pub(super) fn new(entries: &[Entry], surface: &mut Surface) -> Self {
        for entry in entries {
            surface.set_state(entry.id, State::Queued);
        }
        Self { queue: Queue::new(entries), parked: FxHashMap::default() }
    }

    #[inline]
    pub(super) fn put(&mut self, entry: Entry, surface: &mut Surface) {
        surface.set_state(entry.id, State::Queued);
        self.queue.push(entry);
    }

    pub(super) fn park(&mut self, entry: Entry, vertices: &[VertexId], surface: &mut Surface) {
        surface.set_state(entry.id, State::Parked);
        for &v in vertices {
            surface.flag(v, Flags::AWAITED);
            self.parked.entry(v).or_default().push(entry);
        }
    }

    /// Puts the candidates parked at a vertex back into the queue.
    pub(super) fn wake(&mut self, vertex: VertexId, surface: &mut Surface) {
        surface.unflag(vertex, Flags::AWAITED);
        for entry in self.parked.remove(&vertex).into_iter().flatten() {
            self.unpark(entry, surface);
        }
    }

    /// Puts the candidates parked at vertices tied to this one back into the queue, and marks their
    /// costs as out of date.
    pub(super) fn wake_tied(&mut self, vertex: VertexId, surface: &mut Surface) {
        for other in surface.ties.with(vertex).to_vec() {
            surface.touch(other);
            if surface.flags(other).any(Flags::AWAITED) {
                self.wake(other, surface);
            }
        }
    }

    pub(super) fn wake_all(&mut self, surface: &mut Surface) {
        for entry in std::mem::take(&mut self.parked).into_values().flatten() {
            self.unpark(entry, surface);
        }
    }

    /// Puts a candidate in the queue if it is still parked.
    fn unpark(&mut self, entry: Entry, surface: &mut Surface) {
        if surface.state(entry.id) == State::Parked {
            self.put(entry, surface);
        }
    }
}

/// States of the candidates of a surface, as a policy updates them after a contraction.
pub(super) struct SurfaceCandidates<'a> {
    pub(super) surface: &'a mut Surface,
    pub(super) opened: &'a mut Vec<CandidateId>,
}

impl CandidateSink for SurfaceCandidates<'_> {
    fn surface(&self) -> &Surface {
        self.surface
    }

    fn is_open(&self, id: CandidateId) -> bool {
        matches!(self.surface.state(id), State::Queued | State::Parked)
    }

    fn open(&mut self, id: CandidateId) {
        self.opened.push(id);
    }

    fn close(&mut self, id: CandidateId) {
        let state = match self.surface.state(id) {
            State::Queued | State::Ghost => State::Ghost,
            State::Parked | State::Closed => State::Closed,
        };
        self.surface.set_state(id, state);
    }
}
