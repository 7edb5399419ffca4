//! What updates need, written out: for exact answers by the face list, where no neighbours are met.

use super::{Implicit, Order};
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

/// For each update those that it needs beside the ones above it, as far as they do not need each other
/// anyway.
#[derive(Clone, Debug)]
pub struct Links {
    starts: Vec<u32>,
    needs: Vec<u32>,
    /// All updates, each before those that it needs.
    order: Vec<u32>,
}

impl Links {
    /// Those of the forest that the model was made of.
    pub fn new(forest: &Forest, rule: Rule) -> Self {
        Self::in_order(forest, &Order::new(forest), rule)
    }

    /// The same in an order that others share.
    pub(crate) fn in_order(forest: &Forest, order: &Order, rule: Rule) -> Self {
        let parents = forest.parents();
        let mut this = Self {
            starts: Vec::with_capacity(order.updates.len() + 1),
            needs: vec![],
            order: by_level(forest, order),
        };
        let mut found = Vec::new();
        for (at, &update) in order.updates.iter().enumerate() {
            this.starts.push(this.needs.len() as u32);
            let of = &forest.updates[update as usize];
            found.clear();
            if rule == Rule::Strict || of.wings == [NONE; 2] {
                let needed = |&node: &u32| parents[node as usize];
                let ring = forest.ring(update as usize).iter().map(needed);
                found.extend(ring.filter(|&up| up != NONE));
            } else if !of.wings.contains(&NONE) {
                found.extend(lowest_common(forest, &parents, of.wings));
            }
            found.iter_mut().for_each(|up| *up = order.place_of_update[*up as usize]);
            this.add(order, at as u32, &mut found);
        }
        this.starts.push(this.needs.len() as u32);
        this
    }

    /// Adds what an update needs, without what is above it or above another of them.
    fn add(&mut self, order: &Order, update: u32, found: &mut Vec<u32>) {
        found.sort_unstable();
        found.dedup();
        let is_above = |up: u32, down: u32| up < down && down < order.ends[up as usize];
        for (i, &up) in found.iter().enumerate() {
            // Those under it come right behind it.
            let next = found.get(i + 1);
            if !is_above(up, update) && !next.is_some_and(|&next| is_above(up, next)) {
                self.needs.push(up);
            }
        }
    }

    /// What it takes in memory.
    pub fn bytes(&self) -> usize {
        4 * (self.starts.len() + self.needs.len() + self.order.len())
    }

    /// What an update needs beside those above it.
    #[inline]
    pub(crate) fn of(&self, update: u32) -> &[u32] {
        let update = update as usize;
        &self.needs[self.starts[update] as usize..self.starts[update + 1] as usize]
    }

    /// All updates, each before those that it needs.
    pub(crate) fn in_order_of_need(&self) -> &[u32] {
        &self.order
    }

    /// Chooses all that the chosen updates need.
    pub(crate) fn close(&self, mt: &Implicit, chosen: &mut [bool]) {
        let mut waiting: Vec<u32> = Vec::new();
        for update in 0..chosen.len() as u32 {
            if !chosen[update as usize] {
                continue;
            }
            waiting.push(update);
            while let Some(update) = waiting.pop() {
                for &need in self.of(update) {
                    choose(mt, need, chosen, &mut waiting);
                }
            }
        }
    }
}

/// Chooses an update with those above it; those that are new wait for what they need.
fn choose(mt: &Implicit, update: u32, chosen: &mut [bool], waiting: &mut Vec<u32>) {
    let mut next = Some(update);
    while let Some(update) = next.filter(|&update| !chosen[update as usize]) {
        chosen[update as usize] = true;
        waiting.push(update);
        if mt.is_glued(update) && !std::mem::replace(&mut chosen[update as usize + 1], true) {
            waiting.push(update + 1);
        }
        next = mt.family(mt.parent(update));
    }
}

/// All updates, those of low levels first: what they need is above them.
fn by_level(forest: &Forest, order: &Order) -> Vec<u32> {
    let level = |update: u32| usize::from(forest.updates[update as usize].level);
    let top = order.updates.iter().map(|&u| level(u)).max().unwrap_or(0);
    let mut starts = vec![0u32; top + 2];
    order.updates.iter().for_each(|&u| starts[level(u) + 1] += 1);
    (0..=top).for_each(|level| starts[level + 1] += starts[level]);
    let mut sorted = vec![0; order.updates.len()];
    for (at, &update) in order.updates.iter().enumerate() {
        let start = &mut starts[level(update)];
        sorted[*start as usize] = at as u32;
        *start += 1;
    }
    sorted
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
