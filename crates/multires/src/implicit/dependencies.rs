//! What updates need, written out: for exact answers by the face list, where no neighbours are met.

use super::{Implicit, Order};
use crate::forest::by_level;
use crate::forest::{Forest, NONE};

/// What must hold for an update to be made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SplitRule {
    /// All around the vertex is as it was recorded: the cuts are those of the explicit MT.
    #[default]
    Strict,
    /// The two wings are not shown by one vertex. That is what keeps a cut manifold and no more, so
    /// cuts are smaller; but triangles may appear that no contraction has seen, and fold.
    Wings,
}

/// For each update the one that makes its node, and those that it needs beside the ones above it, as
/// far as they do not need each other anyway.
#[derive(Clone, Debug)]
pub(crate) struct Dependencies {
    /// All updates, each before those that it needs, as [`HEAD`]s with what they need behind them.
    lists: Vec<u32>,
    /// Where in the lists each update's needs start.
    starts: Vec<u32>,
}

/// Set where a list begins: there are no more than half of 2³¹ updates. Places in the lists are 32 bits too: rings,
/// which are longer, were numbered so.
const HEAD: u32 = 1 << 31;

impl Dependencies {
    /// Those of the forest, in the order of the model.
    pub(crate) fn in_order(forest: &Forest, order: &Order, rule: SplitRule) -> Self {
        let mut finder = Finder::new(Makers::new(forest, order));
        let (mut needs, mut ends, mut found) = (Vec::new(), Vec::new(), Vec::new());
        for (at, &update) in (0..).zip(&order.updates) {
            let of = &forest.updates[update as usize];
            found.clear();
            if rule == SplitRule::Strict || of.wings == [NONE; 2] {
                finder.around(at, &mut found);
            } else if !of.wings.contains(&NONE) {
                let wings = of.wings.map(|wing| order.maker(wing));
                found.extend(finder.makers.lowest_common(wings));
            }
            needs.extend(finder.makers.family(at));
            reduce(order, at, &mut found);
            needs.append(&mut found);
            ends.push(needs.len() as u32);
        }
        let level = |at: u32| forest.updates[order.updates[at as usize] as usize].level;
        Self::of_needs(&needs, &ends, by_level(ends.len(), level))
    }

    /// The needs of each update, to where they end; low levels first: what they need is above them.
    fn of_needs(needs: &[u32], ends: &[u32], updates: Vec<u32>) -> Self {
        let mut this = Self {
            lists: Vec::with_capacity(needs.len() + ends.len()),
            starts: vec![NONE; ends.len()],
        };
        for update in updates {
            let start = update.checked_sub(1).map_or(0, |before| ends[before as usize]);
            this.lists.push(update | HEAD);
            this.starts[update as usize] = this.lists.len() as u32;
            this.lists.extend(&needs[start as usize..ends[update as usize] as usize]);
        }
        this
    }

    /// What it takes in memory.
    pub(crate) fn bytes(&self) -> usize {
        4 * (self.starts.len() + self.lists.len())
    }

    /// What an update needs, but for what that needs in turn.
    #[inline]
    pub(crate) fn of(&self, update: u32) -> impl Iterator<Item = u32> + '_ {
        let behind = &self.lists[self.starts[update as usize] as usize..];
        behind.iter().copied().take_while(|need| need & HEAD == 0)
    }

    /// All updates, each before those that it needs.
    pub(crate) fn dependents_first(&self) -> impl Iterator<Item = u32> + '_ {
        self.lists.iter().filter(|entry| **entry & HEAD != 0).map(|entry| entry & !HEAD)
    }

    /// Makes the number of each update at least as great as those of the updates that need it.
    pub(crate) fn raise(&self, numbers: &mut [u32]) {
        let mut own = 0;
        for &entry in &self.lists {
            let number = &mut numbers[(entry & !HEAD) as usize];
            // A list has two or three entries: to choose is quicker than to jump.
            own = if entry & HEAD != 0 { *number } else { own };
            *number = own.max(*number);
        }
    }

    /// Chooses all that the chosen updates need.
    pub(crate) fn close(&self, mt: &Implicit, chosen: &mut [bool]) {
        let mut waiting: Vec<u32> = Vec::new();
        for update in 0..chosen.len() as u32 {
            if chosen[update as usize] {
                waiting.push(update);
            }
            while let Some(update) = waiting.pop() {
                for need in self.of(update) {
                    if std::mem::replace(&mut chosen[need as usize], true) {
                        continue;
                    }
                    waiting.push(need);
                    if mt.is_fused_with_child(need)
                        && !std::mem::replace(&mut chosen[need as usize + 1], true)
                    {
                        waiting.push(need + 1);
                    }
                }
            }
        }
    }
}

/// Takes out what is above the update or above another of those that it needs.
fn reduce(order: &Order, update: u32, found: &mut Vec<u32>) {
    found.sort_unstable();
    let is_above = |up: u32, down: u32| up < down && down < order.ends[up as usize];
    let mut kept = 0;
    for i in 0..found.len() {
        let up = found[i];
        // Those under it come right behind it.
        let next = found.get(i + 1);
        if !is_above(up, update) && !next.is_some_and(|&next| is_above(up, next)) {
            found[kept] = up;
            kept += 1;
        }
    }
    found.truncate(kept);
}

/// Of each update the one that makes its node, and those that make its ring, by the model's numbers: side by
/// side, where the forest would be asked about node after node.
struct Makers {
    lists: Vec<u32>,
    /// Where each update's list starts, and the last ends.
    starts: Vec<u32>,
    /// [`NONE`] for those of roots.
    families: Vec<u32>,
}

impl Makers {
    fn new(forest: &Forest, order: &Order) -> Self {
        let mut this = Self {
            lists: Vec::with_capacity(forest.rings.len()),
            starts: vec![0],
            families: Vec::with_capacity(order.updates.len()),
        };
        for &update in &order.updates {
            let update = update as usize;
            this.lists.extend(forest.ring(update).iter().filter_map(|&node| order.maker(node)));
            this.starts.push(this.lists.len() as u32);
            this.families.push(order.maker(forest.node(update) as u32).unwrap_or(NONE));
        }
        this
    }

    fn family(&self, update: u32) -> Option<u32> {
        Some(self.families[update as usize]).filter(|&up| up != NONE)
    }

    fn around(&self, update: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|next| self.starts[update as usize + next] as usize);
        &self.lists[start..end]
    }

    /// The last update that has both nodes under it, by the updates that make them.
    fn lowest_common(&self, mut makers: [Option<u32>; 2]) -> Option<u32> {
        // Updates above have lower numbers.
        loop {
            let [a, b] = [makers[0]?, makers[1]?];
            if a == b {
                return Some(a);
            }
            let lower = usize::from(b > a);
            makers[lower] = self.family(a.max(b));
        }
    }
}

/// Finds what updates need for the sake of their rings.
struct Finder {
    makers: Makers,
    /// By update: the last that was found to need it.
    needed_by: Vec<u32>,
}

/// Longer rings are not searched for what their updates need: a hub is in the rings of all around it.
const MAX_SEARCHED: usize = 64;

impl Finder {
    fn new(makers: Makers) -> Self {
        let needed_by = vec![NONE; makers.families.len()];
        Self { makers, needed_by }
    }

    /// The updates that make the ring of another, without those that others of them need: of two
    /// neighbours in the ring the one that was contracted first had the other around it. A third is
    /// left.
    fn around(&mut self, by: u32, found: &mut Vec<u32>) {
        let Self { makers, needed_by } = self;
        for &up in makers.around(by) {
            if std::mem::replace(&mut needed_by[up as usize], by) != by {
                found.push(up);
            }
        }
        let searched = found.iter().map(|&up| makers.around(up));
        for &up in searched.filter(|ring| ring.len() <= MAX_SEARCHED).flatten() {
            needed_by[up as usize] = NONE;
        }
        found.retain(|&up| needed_by[up as usize] == by);
    }
}
