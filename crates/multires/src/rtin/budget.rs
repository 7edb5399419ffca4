//! The best level of at most so many faces.
//!
//! Every vertex has an urgency: by how much its error exceeds the tolerance, and no less than that of a
//! vertex that needs it. Inserting the most urgent first is making cuts all the way, so choosing is
//! finding where to stop.

use std::cmp::Reverse;

use super::Rtin;
use super::extract::RtinExtractor;
use crate::level::Level;
use crate::query::Criterion;
use crate::query::{Query, QueryError};

/// Urgencies of one bucket differ in these bits only: by a hundredth at most.
const LOW_BITS: u32 = 16;
/// Their highest bit is a sign, and none has it.
const BUCKETS: usize = 1 << (u32::BITS - 1 - LOW_BITS);

impl RtinExtractor<'_> {
    /// The answer to the query whose tolerance is, everywhere, so many times as large that there are
    /// at most so many faces, or so many times smaller that there are no fewer than need be. What the
    /// query does not focus on stays as coarse as it can be; the coarsest level is there in any case.
    ///
    /// Cost: of choosing, linear in the field however many faces are asked for; and of extraction.
    /// # Errors
    /// A query that is none.
    pub fn at_most(&mut self, faces: usize, query: &Query<'_>) -> Result<&Level, QueryError> {
        let criterion = Criterion::new(query, self.model.frame())?;
        self.forget_chosen();
        let base = self.write_chosen().faces.len();
        let priorities = self.model.priorities(&criterion);
        self.choose_most_urgent(&priorities, faces.saturating_sub(base));
        Ok(self.write_chosen())
    }

    /// Chooses the most urgent vertices that bring at most so many faces; none that is not urgent.
    ///
    /// Urgencies are sorted into buckets by their leading bits. All of some buckets fit, none of
    /// others, and one has to be sorted.
    fn choose_most_urgent(&mut self, priorities: &[u32], mut room: usize) {
        let grid = &self.model.grid;
        let mut weights = vec![0usize; BUCKETS];
        for (index, priority) in priorities.iter().enumerate() {
            weights[(priority >> LOW_BITS) as usize] += grid.created_faces(grid.place(index));
        }
        let mut last = BUCKETS;
        // The lowest holds what is not urgent at all.
        while last > 1 && weights[last - 1] <= room {
            last -= 1;
            room -= weights[last];
        }
        let least = (last << LOW_BITS) as u32;
        let next = ((last - 1) << LOW_BITS).max(1) as u32..least;
        let mut tight = Vec::new();
        for (index, priority) in priorities.iter().enumerate() {
            if *priority >= least {
                self.chosen[index] = true;
                self.all_chosen.push(index as u32);
            } else if next.contains(priority) {
                tight.push(index);
            }
        }
        // What is needed is inserted earlier, and no less urgent.
        let key = |index: usize| (Reverse(priorities[index]), grid.depth_of(grid.place(index)));
        tight.sort_unstable_by_key(|&index| (key(index), index));
        for index in tight {
            let Some(rest) = room.checked_sub(grid.created_faces(grid.place(index))) else { break };
            room = rest;
            self.chosen[index] = true;
            self.all_chosen.push(index as u32);
        }
    }
}

impl Rtin {
    /// The urgency of each vertex, as bits: those are in the order of the numbers. What is in every
    /// level has none.
    fn priorities(&self, criterion: &Criterion<'_>) -> Vec<u32> {
        let all = self.vertices.iter().zip(&self.radii).enumerate();
        let balls =
            all.map(|(index, (vertex, &radius))| self.ball(self.grid.place(index), vertex, radius));
        let mut priorities: Vec<u32> =
            criterion.priorities(balls).into_iter().map(f32::to_bits).collect();
        for (priority, vertex) in priorities.iter_mut().zip(&self.vertices) {
            *priority *= u32::from(!vertex.is_forced());
        }
        // Errors are monotone as they are.
        if criterion.is_uniform() {
            return priorities;
        }
        for depth in (0..self.grid.depth()).rev() {
            for place in self.grid.inserted_at(depth) {
                let own = priorities[self.grid.index(place)];
                for parent in self.grid.parents(place) {
                    let above = self.grid.index(parent);
                    if priorities[above] < own && !self.vertices[above].is_forced() {
                        priorities[above] = own;
                    }
                }
            }
        }
        priorities
    }
}
