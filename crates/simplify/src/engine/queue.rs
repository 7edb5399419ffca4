//! The queue of candidates: exact order, and most entries written only once.
//!
//! Costs fall into buckets by their leading bits, eight to the octave. Only the lowest bucket in
//! use is kept in order, as a heap small enough for the cache; the others are plain lists.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use crate::engine::candidates::CandidateId;

/// A cost as the queue orders it: the leading 32 bits of a non-negative double, which sort as it
/// does and keep 20 bits of its mantissa at any scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Key(u32);

impl Key {
    /// The key of a cost; below zero counts as zero, NaN as infinite.
    #[inline]
    pub(crate) fn new(cost: f64) -> Self {
        if cost.is_nan() {
            return Self::new(f64::INFINITY);
        }
        Self((cost.max(0.0).to_bits() >> 32) as u32)
    }

    /// The least cost with this key.
    #[inline]
    pub(crate) fn cost(self) -> f64 {
        f64::from_bits(u64::from(self.0) << 32)
    }

    #[inline]
    fn bucket(self) -> usize {
        (self.0 >> 17) as usize
    }
}

/// Buckets for every non-negative double: 11 bits of exponent, 3 of mantissa.
const BUCKETS: usize = 1 << 14;

/// Fewer entries than this are all kept in order: a scene can have thousands of small meshes, and
/// the empty buckets alone take 400 kB.
const FEW: usize = 4096;

/// A candidate in the queue. Ordered by cost, then by id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Entry {
    pub(crate) key: Key,
    /// The candidate.
    pub(crate) id: CandidateId,
    /// The versions of its vertices when the cost was found.
    pub(crate) stamp: u32,
}

impl Entry {
    /// Both in one word: one comparison in the heap instead of two.
    #[inline]
    fn order(&self) -> u64 {
        u64::from(self.key.0) << 32 | u64::from(self.id.0)
    }
}

impl Ord for Entry {
    #[inline]
    fn cmp(&self, other: &Self) -> Ordering {
        self.order().cmp(&other.order())
    }
}

impl PartialOrd for Entry {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// See the module.
pub(crate) struct Queue {
    /// The entries below bucket `next`, in order.
    front: BinaryHeap<Reverse<Entry>>,
    /// The lowest bucket not yet in `front`.
    next: usize,
    buckets: Vec<Vec<Entry>>,
}

impl Queue {
    pub(crate) fn new(entries: &[Entry]) -> Self {
        if entries.len() < FEW {
            let front = entries.iter().copied().map(Reverse).collect();
            return Self { front, next: BUCKETS, buckets: Vec::new() };
        }
        let mut sizes = vec![0u32; BUCKETS];
        for entry in entries {
            sizes[entry.key.bucket()] += 1;
        }
        let mut buckets: Vec<_> =
            sizes.iter().map(|&size| Vec::with_capacity(size as usize)).collect();
        for &entry in entries {
            buckets[entry.key.bucket()].push(entry);
        }
        Self { front: BinaryHeap::new(), next: 0, buckets }
    }

    #[inline]
    pub(crate) fn push(&mut self, entry: Entry) {
        let bucket = entry.key.bucket();
        if bucket < self.next {
            self.front.push(Reverse(entry));
        } else {
            self.buckets[bucket].push(entry);
        }
    }

    /// The least entry of the front, left where it is; `None` when the front is used up.
    #[inline]
    pub(crate) fn peek(&self) -> Option<Entry> {
        self.front.peek().map(|entry| entry.0)
    }

    /// Takes the least entry of the front; `None` when the front is used up.
    #[inline]
    pub(crate) fn pop(&mut self) -> Option<Entry> {
        self.front.pop().map(|entry| entry.0)
    }

    /// The next bucket that holds anything, for the caller to look through and push again, which
    /// puts what still belongs there to the front. `None` when the queue is used up.
    pub(crate) fn next_bucket(&mut self) -> Option<Vec<Entry>> {
        let ahead = self.buckets.get(self.next..)?.iter().position(|bucket| !bucket.is_empty())?;
        self.next += ahead + 1;
        Some(std::mem::take(&mut self.buckets[self.next - 1]))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn entry(cost: f64, id: u32) -> Entry {
        Entry { key: Key::new(cost), id: CandidateId(id), stamp: 0 }
    }

    fn next(queue: &mut Queue) -> Option<Entry> {
        while queue.peek().is_none() {
            for entry in queue.next_bucket()? {
                queue.push(entry);
            }
        }
        queue.pop()
    }

    #[test]
    fn ties_go_by_id() {
        let mut queue = Queue::new(&[entry(1.0, 9), entry(1.0, 4), entry(0.0, 7)]);
        let ids: Vec<_> = std::iter::from_fn(|| next(&mut queue)).map(|e| e.id.0).collect();
        assert_eq!(ids, [7, 4, 9]);
    }

    #[test]
    fn what_is_not_a_cost_goes_last_or_first() {
        assert_eq!(Key::new(f64::NAN), Key::new(f64::INFINITY));
        assert_eq!(Key::new(-1e-30), Key::new(0.0));
    }

    proptest! {
        #[test]
        fn pops_in_the_order_of_a_sorted_list(
            first in prop_oneof![
                prop::collection::vec((0.0..1e3f64, 0u32..1000), 0..100),
                prop::collection::vec((0.0..1e3f64, 0u32..1000), FEW..FEW + 100),
            ],
            later in prop::collection::vec((0.0..1e3f64, 0u32..1000), 0..100),
            before in 0usize..100,
        ) {
            let entries = |list: Vec<(f64, u32)>| {
                list.into_iter().map(|(cost, id)| entry(cost, id)).collect::<Vec<_>>()
            };
            let mut oracle = entries(first);
            let mut queue = Queue::new(&oracle);
            oracle.sort_by(|a, b| b.cmp(a));
            for _ in 0..before {
                prop_assert_eq!(next(&mut queue), oracle.pop());
            }
            for entry in entries(later) {
                queue.push(entry);
                oracle.push(entry);
            }
            oracle.sort_by(|a, b| b.cmp(a));
            while let Some(least) = oracle.pop() {
                prop_assert_eq!(next(&mut queue), Some(least));
            }
            prop_assert_eq!(next(&mut queue), None);
        }
    }
}
