//! The finest cut within a face budget.
//!
//! The priority of an update is its error relative to the tolerance, and at least that of every
//! update that depends on it. Applying updates by falling priority therefore passes through cuts
//! only, and choosing the best one means finding where to stop.

use std::cmp::Reverse;

use super::{Extractor, Faces, Implicit};
use crate::forest::Stage;
use crate::length16::Length16;
use crate::level::Level;
use crate::model::Model;
use crate::query::Criterion;
use crate::query::{Query, QueryError};

/// Low bits ignored by the bucket of a priority, so that priorities in one bucket differ by one
/// percent at most.
const LOW_BITS: u32 = 16;
/// Number of buckets; the sign bit of a priority is never set.
const BUCKETS: usize = 1 << (u32::BITS - 1 - LOW_BITS);

/// Priority of each update, as the bits of a float, whose order is that of the numbers.
struct Priorities<'m> {
    model: &'m Model,
    of: Vec<u32>,
    /// True if they are stages, and errors among updates of one stage.
    go_by_stages: bool,
}

/// Stop along the falling priorities.
#[derive(Clone, Copy)]
struct Limit {
    /// This bucket and all above it fit; the one below it fits in part.
    bucket: usize,
    /// Number of faces that the partial bucket may add.
    room: usize,
}

/// Number of faces created by an update together with the one fused to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Weight(u8);

impl Extractor<'_> {
    /// Returns the finest mesh of at most `faces` faces that answers the query with its tolerance
    /// scaled by one factor everywhere.
    ///
    /// Outside the focus the mesh stays as coarse as possible, and exact updates
    /// are applied last.
    /// The base mesh is returned even if it exceeds the budget.
    ///
    /// Cost: linear in the updates for choosing, whatever the budget, plus extraction.
    /// # Errors
    /// The query is invalid.
    pub fn at_most(&mut self, faces: usize, query: &Query<'_>) -> Result<&Level, QueryError> {
        let criterion = Criterion::new(query, self.model.implicit().frame())?;
        let room = faces.saturating_sub(self.model.faces().base_faces());
        let mut priorities = Priorities::new(self.model, &criterion);
        if !criterion.is_uniform() || priorities.go_by_stages {
            self.model.dependencies().raise(&mut priorities.of);
        }
        priorities.choose(room, &mut self.chosen);
        Ok(self.write_chosen())
    }
}

impl Weight {
    /// Marks an update that is counted with the one before it.
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
    /// Computes the priorities from the updates' own balls.
    fn new(model: &'m Model, criterion: &Criterion<'_>) -> Self {
        let mt = model.implicit();
        let balls = (0..mt.update_count() as u32).map(|update| mt.ball(update));
        if criterion.is_uniform() && mt.stage(0).is_some() {
            let stage = |update| mt.stage(update).unwrap_or_default();
            let updates = 0..mt.update_count() as u32;
            let of = updates.map(|update| by_stage(stage(update), mt.error(update))).collect();
            return Self { model, of, go_by_stages: true };
        }
        let of = criterion.priorities(balls).into_iter().map(f32::to_bits).collect();
        Self { model, of, go_by_stages: false }
    }

    /// Returns the point where the budget is used up.
    fn limit(&self, room: usize) -> Limit {
        let mut buckets = vec![0u32; BUCKETS];
        for (&priority, weight) in self.of.iter().zip(self.model.weights()) {
            buckets[bucket(priority)] += weight.faces();
        }
        let mut limit = Limit { bucket: BUCKETS, room };
        // The lowest bucket holds the updates of priority 0.
        while limit.bucket > 1 && buckets[limit.bucket - 1] as usize <= limit.room {
            limit.bucket -= 1;
            limit.room -= buckets[limit.bucket] as usize;
        }
        limit
    }

    /// Chooses the updates of highest priority whose faces fit into `room`, without those of
    /// priority 0.
    ///
    /// All of some buckets fit and none of others, so only one bucket has to be sorted.
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
        // A dependency has a higher level and at least the same priority.
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

/// Returns the priority of an update by its stage: latest contractions first, exact ones last.
fn by_stage(stage: Stage, error: Length16) -> u32 {
    let later = u32::from(Stage::COUNT - stage.number());
    if error == Length16::default() { 1 } else { later << LOW_BITS | u32::from(error.0) }
}

fn bucket(priority: u32) -> usize {
    (priority >> LOW_BITS) as usize
}
