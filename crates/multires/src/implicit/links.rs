//! What updates need, written out: for exact answers by the face list, where no neighbours are met.

use super::{Implicit, Order};
use crate::by_level::by_level;
use crate::forest::{Forest, NONE};

/// What must hold for an update to be made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rule {
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
pub(crate) struct Links {
    /// All updates, each before those that it needs, as [`HEAD`]s with what they need behind them.
    lists: Vec<u32>,
    /// Where in the lists each update's needs start.
    starts: Vec<u32>,
}

/// Set where a list begins: there are no more than half of 2³¹ updates.
const HEAD: u32 = 1 << 31;

impl Links {
    /// Those of the forest, in the order of the model.
    pub(crate) fn in_order(forest: &Forest, order: &Order, rule: Rule) -> Self {
        let parents = forest.parents();
        let mut this = Self { lists: vec![], starts: vec![NONE; order.updates.len()] };
        let (mut found, mut finder) = (Vec::new(), Finder::new(forest, &parents));
        // Those of low levels first: what they need is above them.
        let level = |at: u32| forest.updates[order.updates[at as usize] as usize].level;
        for at in by_level(order.updates.len(), level) {
            let update = order.updates[at as usize] as usize;
            let of = &forest.updates[update];
            found.clear();
            if rule == Rule::Strict || of.wings == [NONE; 2] {
                finder.around(update, &mut found);
            } else if !of.wings.contains(&NONE) {
                found.extend(lowest_common(forest, &parents, of.wings));
            }
            found.iter_mut().for_each(|up| *up = order.place_of_update[*up as usize]);
            let family = Some(parents[forest.node(update)]).filter(|&up| up != NONE);
            let family = family.map(|up| order.place_of_update[up as usize]);
            this.add(order, at, family, &mut found);
        }
        this
    }

    /// Adds what an update needs, without what is above it or above another of them, but for its
    /// family.
    fn add(&mut self, order: &Order, update: u32, family: Option<u32>, found: &mut Vec<u32>) {
        found.sort_unstable();
        found.dedup();
        self.lists.push(update | HEAD);
        self.starts[update as usize] = self.lists.len() as u32;
        self.lists.extend(family);
        let is_above = |up: u32, down: u32| up < down && down < order.ends[up as usize];
        for (i, &up) in found.iter().enumerate() {
            // Those under it come right behind it.
            let next = found.get(i + 1);
            if !is_above(up, update) && !next.is_some_and(|&next| is_above(up, next)) {
                self.lists.push(up);
            }
        }
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
    pub(crate) fn in_order_of_need(&self) -> impl Iterator<Item = u32> + '_ {
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
                    if mt.is_glued(need) && !std::mem::replace(&mut chosen[need as usize + 1], true)
                    {
                        waiting.push(need + 1);
                    }
                }
            }
        }
    }
}

/// Finds what updates need for the sake of their rings.
struct Finder<'f> {
    forest: &'f Forest,
    parents: &'f [u32],
    /// By update: the last that was found to need it.
    needed_by: Vec<u32>,
}

/// Longer rings are not searched for what their updates need: a hub is in the rings of all around it.
const MOST_SEARCHED: usize = 64;

impl<'f> Finder<'f> {
    fn new(forest: &'f Forest, parents: &'f [u32]) -> Self {
        Self { forest, parents, needed_by: vec![NONE; forest.updates.len()] }
    }

    /// The updates that make the ring of another, without those that others of them need: of two
    /// neighbours in the ring the one that was contracted first had the other around it. A third is
    /// left.
    fn around(&mut self, update: usize, found: &mut Vec<u32>) {
        let Self { forest, parents, needed_by } = self;
        let makers = |update: usize| {
            let up = forest.ring(update).iter().map(|&node| parents[node as usize]);
            up.filter(|&up| up != NONE)
        };
        let by = update as u32;
        for up in makers(update) {
            if std::mem::replace(&mut needed_by[up as usize], by) != by {
                found.push(up);
            }
        }
        for &up in found.iter().filter(|&&up| forest.ring(up as usize).len() <= MOST_SEARCHED) {
            makers(up as usize).for_each(|up| needed_by[up as usize] = NONE);
        }
        found.retain(|&up| needed_by[up as usize] == by);
    }
}

/// The last update that has both nodes under it.
fn lowest_common(forest: &Forest, parents: &[u32], nodes: [u32; 2]) -> Option<u32> {
    let [mut a, mut b] = nodes;
    // Updates above are later ones.
    loop {
        let [over_a, over_b] = [parents[a as usize], parents[b as usize]];
        if over_a == NONE || over_b == NONE {
            return None;
        }
        if over_a == over_b {
            return Some(over_a);
        }
        if over_a < over_b {
            a = forest.node(over_a as usize) as u32;
        } else {
            b = forest.node(over_b as usize) as u32;
        }
    }
}
