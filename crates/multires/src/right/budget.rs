//! The best level of at most so many faces.
//!
//! Every vertex has an urgency: by how much its error exceeds the tolerance, and no less than that of a
//! vertex that needs it. Inserting the most urgent first is making cuts all the way.

use super::RightTriangles;
use super::extract::RightExtractor;
use super::places::{Extent, Place};
use crate::level::Level;
use crate::need::Need;
use crate::query::{Query, QueryError};

/// Urgencies of one bucket differ in these bits only: by a hundredth at most.
const LOW_BITS: u32 = 16;

impl RightExtractor<'_> {
    /// The answer to the query whose tolerance is, everywhere, so many times as large that there are
    /// at most so many faces, or so many times smaller that there are no fewer than need be. What the
    /// query does not focus on stays as coarse as it can be; the coarsest level is there in any case.
    ///
    /// Cost: linear in the field, not in the faces asked for.
    /// # Errors
    /// A query that is none.
    pub fn at_most(&mut self, faces: usize, query: &Query<'_>) -> Result<&Level, QueryError> {
        let need = Need::new(query, self.model.frame())?;
        self.forget_chosen();
        let base = self.write_chosen().faces.len();
        let urgencies = self.model.urgencies(&need);
        self.choose_most_urgent(&urgencies, faces.saturating_sub(base));
        Ok(self.write_chosen())
    }

    /// Chooses the most urgent vertices that bring at most so many faces; none that is not urgent.
    ///
    /// Urgencies are sorted into buckets by their leading bits. All of some buckets fit, none of
    /// others, and one has to be sorted.
    fn choose_most_urgent(&mut self, urgencies: &[u32], room: usize) {
        let Self { model, chosen, all_chosen, .. } = self;
        let bucket = |index: usize| (urgencies[index] >> LOW_BITS) as usize;
        let mut weights = vec![0usize; 1 << (u32::BITS - LOW_BITS)];
        let urgent = || model.inserted().filter(|&(_, index)| urgencies[index] > 0);
        urgent().for_each(|(place, index)| weights[bucket(index)] += model.brings(place));
        let (mut left, mut last) = (room, weights.len());
        while last > 0 && weights[last - 1] <= left {
            last -= 1;
            left -= weights[last];
        }
        let mut tight: Vec<_> = urgent().filter(|&(_, index)| bucket(index) + 1 == last).collect();
        // Stable: what is needed is inserted earlier, and no less urgent.
        tight.sort_by_key(|&(_, index)| std::cmp::Reverse(urgencies[index]));
        let fit = tight.into_iter().take_while(|&(place, _)| {
            let rest = left.checked_sub(model.brings(place));
            left = rest.unwrap_or(0);
            rest.is_some()
        });
        for (_, index) in urgent().filter(|&(_, index)| bucket(index) >= last).chain(fit) {
            chosen[index] = true;
            all_chosen.push(index as u32);
        }
    }
}

impl RightTriangles {
    /// All vertices that not every level has, with their indices, those that are needed first.
    fn inserted(&self) -> impl Iterator<Item = (Place, usize)> {
        let all = (0..self.grid.depth()).flat_map(|depth| self.grid.inserted_at(depth));
        let all = all.map(|place| (place, self.grid.index(place)));
        all.filter(|&(_, index)| !self.vertices[index].is_forced())
    }

    /// How many triangles more there are with a vertex.
    fn brings(&self, place: Place) -> usize {
        let coarse = self.grid.diamond(place).into_iter().flat_map(|d| d.coarse());
        coarse.filter(|triangle| self.grid.extent(triangle) != Extent::Outside).count()
    }

    /// The urgency of each vertex, as bits: those are in the order of the numbers.
    fn urgencies(&self, need: &Need<'_>) -> Vec<u32> {
        let mut urgencies = vec![0u32; self.vertices.len()];
        for depth in (0..self.grid.depth()).rev() {
            for place in self.grid.inserted_at(depth) {
                let index = self.grid.index(place);
                if self.vertices[index].is_forced() {
                    continue;
                }
                let own = need.urgency(&self.own_ball(place)).to_bits().max(urgencies[index]);
                urgencies[index] = own;
                for parent in self.grid.parents(place) {
                    let above = &mut urgencies[self.grid.index(parent)];
                    *above = own.max(*above);
                }
            }
        }
        urgencies
    }
}
