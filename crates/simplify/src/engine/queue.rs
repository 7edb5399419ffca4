//! Candidate queue with exact order, in which most entries are written only once.
//!
//! Costs are sorted into buckets by their leading bits, eight to the octave. Only the lowest bucket
//! in use is kept in order, as a heap small enough for the cache. The others are plain lists.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use crate::surface::candidate_states::CandidateId;

/// Sort key of a cost: the leading 32 bits of a non-negative `f64`, which preserve its order and 20
/// bits of its mantissa at any scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Key(u32);

impl Key {
    /// Returns the key of a cost. Negative costs count as zero, NaN as infinite.
    #[inline]
    pub(crate) fn new(cost: f64) -> Self {
        if cost.is_nan() {
            return Self::new(f64::INFINITY);
        }
        Self((cost.max(0.0).to_bits() >> 32) as u32)
    }

    /// Returns the smallest cost with this key.
    #[inline]
    pub(crate) fn cost(self) -> f64 {
        f64::from_bits(u64::from(self.0) << 32)
    }

    #[inline]
    fn bucket(self) -> usize {
        (self.0 >> 17) as usize
    }
}

/// Number of buckets for non-negative doubles: 11 bits of exponent, 3 of mantissa.
const BUCKETS: usize = 1 << 14;

/// Number of entries below which all are kept in order: a scene can have thousands of small meshes,
/// and the empty buckets alone take 400 kB.
const ORDERED_BELOW: usize = 4096;

/// Queue entry of a candidate. Ordered by cost, then by id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Entry {
    pub(crate) key: Key,
    /// Edge or face that the queue entry stands for.
    pub(crate) id: CandidateId,
    /// Sum of the versions of its vertices when the cost was computed.
    pub(crate) stamp: u32,
}

impl Entry {
    /// Packs cost and id into one word, so that the heap compares once.
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

/// Bucket queue with a heap for the cheapest entries; see the module documentation.
pub(crate) struct Queue {
    /// Heap of the entries below bucket `next`.
    front: BinaryHeap<Reverse<Entry>>,
    /// Lowest bucket that is not in `front` yet.
    next: usize,
    buckets: Vec<Vec<Entry>>,
}

impl Queue {
    pub(crate) fn new(entries: &[Entry]) -> Self {
        if entries.len() < ORDERED_BELOW {
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

    /// Returns the smallest entry of the front without removing it; `None` if the front is empty.
    #[inline]
    pub(crate) fn peek(&self) -> Option<Entry> {
        self.front.peek().map(|entry| entry.0)
    }

    /// Removes the smallest entry of the front; `None` if the front is empty.
    #[inline]
    pub(crate) fn pop(&mut self) -> Option<Entry> {
        self.front.pop().map(|entry| entry.0)
    }

    /// Removes and returns the entries of the next non-empty bucket; the caller refreshes and
    /// pushes them again, which moves those that still belong there to the front. `None` if the
    /// queue is empty.
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
                prop::collection::vec((0.0..1e3f64, 0u32..1000), ORDERED_BELOW..ORDERED_BELOW + 100),
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
