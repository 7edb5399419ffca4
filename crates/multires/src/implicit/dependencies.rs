//! Dependencies between updates as explicit lists, for exact answers by the face list, where no
//! neighbours are visited.

use super::{Implicit, Order};
use crate::forest::by_level;
use crate::forest::{Forest, NONE};

/// Condition under which a vertex may be split.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SplitRule {
    /// A vertex may be split if its star is the recorded one. The cuts are those of the explicit
    /// MT.
    #[default]
    Strict,
    /// A vertex may be split if its two wings, the neighbours that both halves keep, are shown by
    /// different vertices.
    ///
    /// This is just what keeps a cut manifold, so cuts are smaller; but triangles can appear that
    /// no contraction has checked, and fold over.
    Wings,
}

/// For each update, the one that creates its node and those it depends on other than its ancestors,
/// reduced by the dependencies that others imply.
#[derive(Clone, Debug)]
pub(crate) struct Dependencies {
    /// All updates, each before its dependencies: a number with [`HEAD`] set, followed by its
    /// dependencies.
    lists: Vec<u32>,
    /// Start of each update's dependencies in the lists.
    starts: Vec<u32>,
}

/// Marks the head of a list. There are fewer than 2³⁰ updates, so the bit is free; list positions
/// fit 32 bits because the rings, which are longer, do.
const HEAD: u32 = 1 << 31;

impl Dependencies {
    /// Collects the dependencies of a forest's updates, in the order of the model.
    pub(crate) fn in_order(forest: &Forest, order: &Order, rule: SplitRule) -> Self {
        let mut finder = Finder::new(Creators::new(forest, order));
        let (mut dependencies, mut ends, mut found) = (Vec::new(), Vec::new(), Vec::new());
        for (at, &update) in (0..).zip(&order.updates) {
            let of = &forest.updates[update as usize];
            found.clear();
            if rule == SplitRule::Strict || of.wings == [NONE; 2] {
                finder.around(at, &mut found);
            } else if !of.wings.contains(&NONE) {
                let wings = of.wings.map(|wing| order.creator(wing));
                found.extend(finder.creators.lowest_common(wings));
            }
            dependencies.extend(finder.creators.parent(at));
            reduce(order, at, &mut found);
            dependencies.append(&mut found);
            ends.push(dependencies.len() as u32);
        }
        let level = |at: u32| forest.updates[order.updates[at as usize] as usize].level;
        Self::from_lists(&dependencies, &ends, by_level(ends.len(), level))
    }

    /// Builds the lists from concatenated dependencies and their ends. Low levels go first, as
    /// dependencies have higher ones.
    fn from_lists(dependencies: &[u32], ends: &[u32], updates: Vec<u32>) -> Self {
        let mut this = Self {
            lists: Vec::with_capacity(dependencies.len() + ends.len()),
            starts: vec![NONE; ends.len()],
        };
        for update in updates {
            let start = update.checked_sub(1).map_or(0, |before| ends[before as usize]);
            this.lists.push(update | HEAD);
            this.starts[update as usize] = this.lists.len() as u32;
            this.lists.extend(&dependencies[start as usize..ends[update as usize] as usize]);
        }
        this
    }

    /// Returns the memory used.
    pub(crate) fn bytes(&self) -> usize {
        4 * (self.starts.len() + self.lists.len())
    }

    /// Returns the direct dependencies of an update.
    #[inline]
    pub(crate) fn of(&self, update: u32) -> impl Iterator<Item = u32> + '_ {
        let behind = &self.lists[self.starts[update as usize] as usize..];
        behind.iter().copied().take_while(|dependency| dependency & HEAD == 0)
    }

    /// Returns all updates, each before its dependencies.
    pub(crate) fn dependents_first(&self) -> impl Iterator<Item = u32> + '_ {
        self.lists.iter().filter(|entry| **entry & HEAD != 0).map(|entry| entry & !HEAD)
    }

    /// Raises the number of each update to at least those of its dependents.
    pub(crate) fn raise(&self, numbers: &mut [u32]) {
        let mut own = 0;
        for &entry in &self.lists {
            let number = &mut numbers[(entry & !HEAD) as usize];
            // Lists have two or three entries, so a conditional move beats a branch.
            own = if entry & HEAD != 0 { *number } else { own };
            *number = own.max(*number);
        }
    }

    /// Adds all dependencies of the chosen updates.
    pub(crate) fn close(&self, mt: &Implicit, chosen: &mut [bool]) {
        let mut waiting: Vec<u32> = Vec::new();
        for update in 0..chosen.len() as u32 {
            if chosen[update as usize] {
                waiting.push(update);
            }
            while let Some(update) = waiting.pop() {
                for dependency in self.of(update) {
                    if std::mem::replace(&mut chosen[dependency as usize], true) {
                        continue;
                    }
                    waiting.push(dependency);
                    if mt.is_fused_with_child(dependency)
                        && !std::mem::replace(&mut chosen[dependency as usize + 1], true)
                    {
                        waiting.push(dependency + 1);
                    }
                }
            }
        }
    }
}

/// Removes ancestors of the update and ancestors of its other dependencies.
fn reduce(order: &Order, update: u32, found: &mut Vec<u32>) {
    found.sort_unstable();
    let is_above = |up: u32, down: u32| up < down && down < order.ends[up as usize];
    let mut kept = 0;
    for i in 0..found.len() {
        let up = found[i];
        // Descendants come right behind their ancestor.
        let next = found.get(i + 1);
        if !is_above(up, update) && !next.is_some_and(|&next| is_above(up, next)) {
            found[kept] = up;
            kept += 1;
        }
    }
    found.truncate(kept);
}

/// For each update the one that creates its node and those that create its ring, by the model's
/// numbers. Kept side by side, so that the forest is not searched node by node.
struct Creators {
    lists: Vec<u32>,
    /// Start of each update's list, and the end of the last one.
    starts: Vec<u32>,
    /// Update that creates each update's node; [`NONE`] for roots.
    parents: Vec<u32>,
}

impl Creators {
    fn new(forest: &Forest, order: &Order) -> Self {
        let mut this = Self {
            lists: Vec::with_capacity(forest.rings.len()),
            starts: vec![0],
            parents: Vec::with_capacity(order.updates.len()),
        };
        for &update in &order.updates {
            let update = update as usize;
            this.lists.extend(forest.ring(update).iter().filter_map(|&node| order.creator(node)));
            this.starts.push(this.lists.len() as u32);
            this.parents.push(order.creator(forest.node(update) as u32).unwrap_or(NONE));
        }
        this
    }

    fn parent(&self, update: u32) -> Option<u32> {
        Some(self.parents[update as usize]).filter(|&up| up != NONE)
    }

    fn around(&self, update: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|next| self.starts[update as usize + next] as usize);
        &self.lists[start..end]
    }

    /// Returns the lowest update that is an ancestor of both nodes, given the updates that create
    /// them.
    fn lowest_common(&self, mut creators: [Option<u32>; 2]) -> Option<u32> {
        // Ancestors have lower numbers.
        loop {
            let [a, b] = [creators[0]?, creators[1]?];
            if a == b {
                return Some(a);
            }
            let lower = usize::from(b > a);
            creators[lower] = self.parent(a.max(b));
        }
    }
}

/// Finds the dependencies of updates on their rings.
struct Finder {
    creators: Creators,
    /// Last update found to depend on each one.
    needed_by: Vec<u32>,
}

/// Longest ring that is searched for implied dependencies: a hub is in the rings of all its
/// neighbours.
const MAX_SEARCHED: usize = 64;

impl Finder {
    fn new(creators: Creators) -> Self {
        let needed_by = vec![NONE; creators.parents.len()];
        Self { creators, needed_by }
    }

    /// Finds the updates that create the ring of another, without those that are implied. Of two
    /// neighbours in the ring, the one contracted first had the other around it, so its update
    /// depends on the other's. About a third is left.
    fn around(&mut self, by: u32, found: &mut Vec<u32>) {
        let Self { creators, needed_by } = self;
        for &up in creators.around(by) {
            if std::mem::replace(&mut needed_by[up as usize], by) != by {
                found.push(up);
            }
        }
        let searched = found.iter().map(|&up| creators.around(up));
        for &up in searched.filter(|ring| ring.len() <= MAX_SEARCHED).flatten() {
            needed_by[up as usize] = NONE;
        }
        found.retain(|&up| needed_by[up as usize] == by);
    }
}
