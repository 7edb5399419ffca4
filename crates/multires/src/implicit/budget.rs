//! The best cut of at most so many faces.
//!
//! Every update has an urgency: by how much its error exceeds the tolerance, and no less than that of
//! an update that needs it. Making the most urgent first is making cuts all the way.

use std::cmp::Reverse;

use super::{Extractor, Links};
use crate::level::Level;
use crate::need::Need;
use crate::query::{Query, QueryError};

/// Urgencies of one bucket differ in these bits only: by a hundredth at most.
const LOW_BITS: u32 = 16;

impl Extractor<'_> {
    /// The answer to the query whose tolerance is, everywhere, so many times as large that there are
    /// at most so many faces, or so many times smaller that there are no fewer than need be. What the
    /// query does not focus on stays as coarse as it can be; the base is there in any case.
    ///
    /// Cost: linear in the updates, not in the faces asked for.
    /// # Errors
    /// A query that is none.
    pub fn at_most(
        &mut self,
        faces: usize,
        links: &Links,
        query: &Query<'_>,
    ) -> Result<&Level, QueryError> {
        let need = Need::new(query, self.mt.frame())?;
        let urgencies = self.urgencies(&need, links);
        self.choose_most_urgent(&urgencies, faces.saturating_sub(self.faces.base_faces()));
        Ok(self.write_chosen())
    }

    /// The urgency of each update, as bits: those are in the order of the numbers.
    fn urgencies(&self, need: &Need<'_>, links: &Links) -> Vec<u32> {
        let mt = self.mt;
        let urgency = |update| need.urgency(&mt.ball(update)).to_bits();
        let mut urgencies: Vec<u32> = (0..mt.update_count() as u32).map(urgency).collect();
        for &update in links.in_order_of_need() {
            let own = urgencies[update as usize];
            let above = mt.family(mt.parent(update));
            for &up in links.of(update).iter().chain(&above) {
                urgencies[up as usize] = urgencies[up as usize].max(own);
            }
        }
        urgencies
    }

    /// Chooses the most urgent updates that bring at most so many faces; none that is not urgent.
    ///
    /// Urgencies are sorted into buckets by their leading bits. All of some buckets fit, none of
    /// others, and one has to be sorted.
    fn choose_most_urgent(&mut self, urgencies: &[u32], room: usize) {
        let Self { mt, faces, chosen, .. } = self;
        let weight = |update: u32| match mt.is_glued(update) {
            true => faces.brought(update) + faces.brought(update + 1),
            false => faces.brought(update),
        };
        let bucket = |update: u32| (urgencies[update as usize] >> LOW_BITS) as usize;
        let urgent = || {
            let all = 0..urgencies.len() as u32;
            all.filter(|&update| urgencies[update as usize] > 0 && !mt.is_inner(update))
        };
        let mut weights = vec![0usize; 1 << (u32::BITS - LOW_BITS)];
        urgent().for_each(|update| weights[bucket(update)] += weight(update));
        let (mut left, mut last) = (room, weights.len());
        while last > 0 && weights[last - 1] <= left {
            last -= 1;
            left -= weights[last];
        }
        let mut tight: Vec<u32> = urgent().filter(|&update| bucket(update) + 1 == last).collect();
        // What is needed is of a higher level, and no less urgent.
        let key = |update: u32| Reverse((urgencies[update as usize], mt.level(update)));
        tight.sort_unstable_by_key(|&update| (key(update), update));
        let fit = tight.into_iter().take_while(|&update| {
            let rest = left.checked_sub(weight(update));
            left = rest.unwrap_or(0);
            rest.is_some()
        });
        chosen.clear();
        chosen.resize(urgencies.len(), false);
        for update in urgent().filter(|&update| bucket(update) >= last).chain(fit) {
            chosen[update as usize] = true;
            if mt.is_glued(update) {
                chosen[update as usize + 1] = true;
            }
        }
    }
}
