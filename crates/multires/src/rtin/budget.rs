//! The finest level within a face budget.
//!
//! The priority of a vertex is its error relative to the tolerance, and at least that of every
//! vertex that depends on it. Inserting vertices by falling priority therefore passes through cuts
//! only, and choosing the best one means finding where to stop.

use std::cmp::Reverse;

use super::Rtin;
use super::extract::RtinExtractor;
use crate::level::Level;
use crate::query::Criterion;
use crate::query::{Query, QueryError};

/// Low bits ignored by the bucket of a priority, so that priorities in one bucket differ by one
/// percent at most.
const LOW_BITS: u32 = 16;
/// Number of buckets; the sign bit of a priority is never set.
const BUCKETS: usize = 1 << (u32::BITS - 1 - LOW_BITS);

impl RtinExtractor<'_> {
    /// Returns the finest mesh of at most `faces` faces that answers the query with its tolerance
    /// scaled by one factor everywhere.
    ///
    /// Outside the focus the mesh stays as coarse as possible. The coarsest level is returned even
    /// if it exceeds the budget.
    ///
    /// Cost: linear in the field for choosing, whatever the budget, plus extraction.
    /// # Errors
    /// The query is invalid.
    pub fn at_most(&mut self, faces: usize, query: &Query<'_>) -> Result<&Level, QueryError> {
        let criterion = Criterion::new(query, self.model.frame())?;
        self.forget_chosen();
        let base = self.write_chosen().faces.len();
        let priorities = self.model.priorities(&criterion);
        self.choose_by_priority(&priorities, faces.saturating_sub(base));
        Ok(self.write_chosen())
    }

    /// Chooses the vertices of highest priority whose faces fit into `room`, without those of
    /// priority 0.
    ///
    /// All of some buckets fit and none of others, so only one bucket has to be sorted.
    fn choose_by_priority(&mut self, priorities: &[u32], mut room: usize) {
        let grid = &self.model.grid;
        let mut weights = vec![0usize; BUCKETS];
        for (index, priority) in priorities.iter().enumerate() {
            weights[(priority >> LOW_BITS) as usize] += grid.created_faces(grid.place(index));
        }
        let mut last = BUCKETS;
        // The lowest bucket holds the vertices of priority 0.
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
        // A dependency is inserted earlier and has at least the same priority.
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
    /// Returns the priority of each vertex, as the bits of a float, whose order is that of the
    /// numbers. Vertices of the coarsest level get 0.
    fn priorities(&self, criterion: &Criterion<'_>) -> Vec<u32> {
        let all = self.vertices.iter().zip(&self.radii).enumerate();
        let balls =
            all.map(|(index, (vertex, &radius))| self.ball(self.grid.place(index), vertex, radius));
        let mut priorities: Vec<u32> =
            criterion.priorities(balls).into_iter().map(f32::to_bits).collect();
        for (priority, vertex) in priorities.iter_mut().zip(&self.vertices) {
            *priority *= u32::from(!vertex.is_forced());
        }
        // Errors are monotone already.
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
