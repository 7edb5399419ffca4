//! The best cut of at most so many faces.
//!
//! Every update has an urgency: by how much its error exceeds the tolerance, and no less than that of
//! an update that needs it. Making the most urgent first is making cuts all the way, so choosing is
//! finding where to stop.

use std::cmp::Reverse;

use super::{Extractor, Faces, Implicit};
use crate::level::Level;
use crate::model::Model;
use crate::query::Criterion;
use crate::query::{Query, QueryError};

/// Urgencies of one bucket differ in these bits only: by a hundredth at most.
const LOW_BITS: u32 = 16;
/// Their highest bit is a sign, and none has it.
const BUCKETS: usize = 1 << (u32::BITS - 1 - LOW_BITS);

/// The urgency of each update, as bits: those are in the order of the numbers.
struct Priorities<'m> {
    model: &'m Model,
    of: Vec<u32>,
}

/// Where the most urgent updates end that bring at most so many faces.
#[derive(Clone, Copy)]
struct Limit {
    /// All of this bucket and those above it fit, and of the one below a part.
    bucket: usize,
    /// How many faces may come of that part.
    room: usize,
}

/// How many faces an update brings, with the one that goes with it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Weight(u8);

impl Extractor<'_> {
    /// The answer to the query whose tolerance is, everywhere, so many times as large that there are
    /// at most so many faces, or so many times smaller that there are no fewer than need be. What the
    /// query does not focus on stays as coarse as it can be, and so does what is exact when coarse; the
    /// base is there in any case.
    ///
    /// Cost: of choosing, linear in the updates however many faces are asked for; and of extraction.
    /// # Errors
    /// A query that is none.
    pub fn at_most(&mut self, faces: usize, query: &Query<'_>) -> Result<&Level, QueryError> {
        let criterion = Criterion::new(query, self.model.implicit().frame())?;
        let room = faces.saturating_sub(self.model.faces().base_faces());
        let mut priorities = Priorities::new(self.model, &criterion);
        if !criterion.is_uniform() {
            self.model.dependencies().raise(&mut priorities.of);
        }
        priorities.choose(room, &mut self.chosen);
        Ok(self.write_chosen())
    }
}

impl Weight {
    /// It goes with the one before it.
    const INNER: Self = Self(u8::MAX);

    pub(crate) fn all(mt: &Implicit, faces: &Faces) -> Vec<Self> {
        let weight = |update: u32| match mt.is_fused_with_child(update) {
            _ if mt.is_fused_with_parent(update) => Self::INNER,
            true => Self((faces.created_count(update) + faces.created_count(update + 1)) as u8),
            false => Self(faces.created_count(update) as u8),
        };
        (0..mt.update_count() as u32).map(weight).collect()
    }

    #[inline]
    fn faces(self) -> u32 {
        if self == Self::INNER { 0 } else { self.0.into() }
    }
}

impl<'m> Priorities<'m> {
    /// As the updates' own balls have them.
    fn new(model: &'m Model, criterion: &Criterion<'_>) -> Self {
        let mt = model.implicit();
        let balls = (0..mt.update_count() as u32).map(|update| mt.ball(update));
        Self { model, of: criterion.priorities(balls).into_iter().map(f32::to_bits).collect() }
    }

    /// Where those end that bring so many faces.
    fn limit(&self, room: usize) -> Limit {
        let mut buckets = vec![0u32; BUCKETS];
        for (&priority, weight) in self.of.iter().zip(self.model.weights()) {
            buckets[bucket(priority)] += weight.faces();
        }
        let mut limit = Limit { bucket: BUCKETS, room };
        // The lowest holds what is not urgent at all.
        while limit.bucket > 1 && buckets[limit.bucket - 1] as usize <= limit.room {
            limit.bucket -= 1;
            limit.room -= buckets[limit.bucket] as usize;
        }
        limit
    }

    /// Chooses the most urgent that bring at most so many faces; none that is not urgent.
    ///
    /// All of some buckets fit, none of others, and one has to be sorted.
    fn choose(&self, room: usize, chosen: &mut Vec<bool>) {
        let (mt, weights) = (self.model.implicit(), self.model.weights());
        let mut limit = self.limit(room);
        let least = (limit.bucket << LOW_BITS) as u32;
        chosen.clear();
        chosen.extend(self.of.iter().map(|&priority| priority >= least));
        let mut tight = Vec::new();
        let next = ((limit.bucket - 1) << LOW_BITS).max(1) as u32..least;
        for (update, priority) in self.of.iter().enumerate() {
            if next.contains(priority) && weights[update] != Weight::INNER {
                tight.push(update as u32);
            }
        }
        for update in 1..chosen.len() {
            if weights[update] == Weight::INNER {
                chosen[update] = chosen[update - 1];
            }
        }
        // What is needed is of a higher level, and no less urgent.
        let key = |update: u32| Reverse((self.of[update as usize], mt.level(update)));
        tight.sort_unstable_by_key(|&update| (key(update), update));
        for update in tight {
            let Some(rest) = limit.room.checked_sub(weights[update as usize].faces() as usize)
            else {
                break;
            };
            limit.room = rest;
            chosen[update as usize] = true;
            if mt.is_fused_with_child(update) {
                chosen[update as usize + 1] = true;
            }
        }
    }
}

fn bucket(priority: u32) -> usize {
    (priority >> LOW_BITS) as usize
}
