//! The best cut of at most so many faces.
//!
//! Every update has an urgency: by how much its error exceeds the tolerance, and no less than that of
//! an update that needs it. Making the most urgent first is making cuts all the way.

use super::{Extractor, Links};
use crate::level::Level;
use crate::need::Need;
use crate::query::{Query, QueryError};

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

    /// The urgency of each update, in the order of its bits, and its level below that: so whatever is
    /// needed comes first, also among equals.
    fn urgencies(&self, need: &Need<'_>, links: &Links) -> Vec<u64> {
        let mt = self.mt;
        let updates = 0..mt.update_count() as u32;
        let urgency = |update| need.urgency(&mt.ball(update)).to_bits();
        let mut urgencies: Vec<u32> = updates.clone().map(urgency).collect();
        for &update in links.in_order_of_need() {
            let own = urgencies[update as usize];
            let above = mt.family(mt.parent(update));
            for &up in links.of(update).iter().chain(&above) {
                urgencies[up as usize] = urgencies[up as usize].max(own);
            }
        }
        let with_level =
            |update: u32| u64::from(urgencies[update as usize]) << 16 | u64::from(mt.level(update));
        updates.map(with_level).collect()
    }

    /// Chooses the most urgent updates that bring at most so many faces; none that is not urgent.
    fn choose_most_urgent(&mut self, urgencies: &[u64], room: usize) {
        let mt = self.mt;
        let weight = |update: u32| match mt.is_glued(update) {
            true => self.faces.brought(update) + self.faces.brought(update + 1),
            false => self.faces.brought(update),
        };
        let is_urgent = |update: u32| urgencies[update as usize] >> 16 > 0 && !mt.is_inner(update);
        let bucket = |update: u32| (urgencies[update as usize] >> 32) as usize;
        let mut weights = vec![0usize; 1 << 16];
        let urgent: Vec<u32> = (0..urgencies.len() as u32).filter(|&u| is_urgent(u)).collect();
        urgent.iter().for_each(|&update| weights[bucket(update)] += weight(update));
        let mut left = room;
        let mut last = weights.len();
        while last > 0 && weights[last - 1] <= left {
            last -= 1;
            left -= weights[last];
        }
        let mut tight: Vec<u32> =
            urgent.iter().copied().filter(|&update| bucket(update) + 1 == last).collect();
        tight.sort_unstable_by_key(|&update| {
            (std::cmp::Reverse(urgencies[update as usize]), update)
        });
        let mut chosen = std::mem::take(&mut self.chosen);
        chosen.clear();
        chosen.resize(urgencies.len(), false);
        let whole = urgent.iter().copied().filter(|&update| bucket(update) >= last);
        let fit = tight.into_iter().take_while(|&update| {
            let fits = weight(update) <= left;
            left = left.saturating_sub(weight(update));
            fits
        });
        for update in whole.chain(fit) {
            chosen[update as usize] = true;
            if mt.is_glued(update) {
                chosen[update as usize + 1] = true;
            }
        }
        self.chosen = chosen;
    }
}
