//! A queue of vertices in buckets, four to the octave.
//!
//! The bucket is given by the leading bits of the cost as a float. Within a bucket the last vertex
//! in is the first one out: what was just queued is in the cache. Mean error of horse-97k at 10 %
//! by buckets per octave: 8 .00719, 4 .00720, 2 .00726, 1 .00730.

use crate::kernel::mesh::vertex::{NO_VERTEX, Vertex};

/// Number of bits of a float below its bucket: all of the mantissa's 23 but two.
const SUB_BUCKET_BITS: u32 = 21;

/// Number of buckets for finite costs.
const BUCKETS: usize = (f32::INFINITY.to_bits() >> SUB_BUCKET_BITS) as usize;

/// Bucket of a vertex that is not queued.
pub(crate) const NONE: u16 = u16::MAX;

/// Number of vertices taken in one batch and made ready before the first is tried.
pub(crate) const BATCH_LEN: usize = 16;

/// Number in a batch within an error bound, where steps are measured side by side: a thread that has
/// gone to sleep takes as long to wake up as a dozen take to be measured.
pub(crate) const BOUNDED_BATCH_LEN: usize = 64;

/// Vertices by the bucket of their cost.
pub(crate) struct BucketQueue {
    buckets: Vec<Vec<u32>>,
    /// Lower bound: no bucket below has an entry.
    lowest: usize,
    /// The current batch, next vertex last. All are from one bucket, and no longer in it.
    next: Vec<u32>,
    /// Bucket of `next`. No bucket below has an entry.
    front: u16,
}

/// Returns the bucket of a cost; `NONE` for infinity and NaN.
#[inline(always)]
pub(crate) fn bucket(cost: f32) -> u16 {
    let bucket = cost.max(0.0).to_bits() >> SUB_BUCKET_BITS;
    if cost < f32::INFINITY { bucket as u16 } else { NONE }
}

/// Returns the smallest cost in a bucket.
pub(crate) fn min_cost_in(bucket: u16) -> f32 {
    f32::from_bits(u32::from(bucket) << SUB_BUCKET_BITS)
}

/// Returns the bucket of the greatest finite costs.
pub(crate) const fn last_bucket() -> u16 {
    BUCKETS as u16 - 1
}

impl Default for BucketQueue {
    fn default() -> Self {
        Self {
            buckets: vec![Vec::new(); BUCKETS],
            lowest: BUCKETS,
            next: Vec::with_capacity(BOUNDED_BATCH_LEN),
            front: 0,
        }
    }
}

impl BucketQueue {
    /// Queues a vertex. Does nothing for the bucket `NONE`.
    #[inline(always)]
    pub(crate) fn push(&mut self, vertex: u32, bucket: u16) {
        if let Some(list) = self.buckets.get_mut(bucket as usize) {
            list.push(vertex);
            self.lowest = self.lowest.min(bucket as usize);
        }
    }

    /// Queues a vertex at the front again after its edges were refused, if it is not queued.
    #[cold]
    pub(crate) fn wake(&mut self, vertex: &mut Vertex, id: u32, front: u16) {
        vertex.floor = 0;
        if vertex.bucket == NONE {
            vertex.target = NO_VERTEX;
            vertex.bucket = front;
            self.push(id, front);
        }
    }

    /// Takes the next batch, of at most `len`, once the one before is used up. Returns false if all
    /// entries are behind `last`.
    #[inline(always)]
    pub(crate) fn take(&mut self, last: u16, len: usize) -> bool {
        while self.lowest <= last as usize {
            let Some(list) = self.buckets.get_mut(self.lowest) else { return false };
            if !list.is_empty() {
                self.front = self.lowest as u16;
                self.next.extend(list.drain(list.len().saturating_sub(len)..));
                return true;
            }
            self.lowest += 1;
        }
        false
    }

    /// Returns the current batch, next vertex last, and its bucket.
    #[inline(always)]
    pub(crate) fn next(&self) -> (&[u32], u16) {
        (&self.next, self.front)
    }

    /// Removes the next vertex of the batch.
    #[inline(always)]
    pub(crate) fn pop(&mut self) -> Option<u32> {
        self.next.pop()
    }

    /// Returns the batch to its bucket, before entries are pushed that may come first.
    pub(crate) fn put_back(&mut self) {
        if let Some(list) = self.buckets.get_mut(self.front as usize) {
            list.append(&mut self.next);
        }
    }

    /// Returns a lower bound on the buckets that have entries.
    pub(crate) fn lowest(&self) -> usize {
        if self.next.is_empty() { self.lowest } else { self.front.into() }
    }

    /// Returns the number of entries in each bucket.
    pub(crate) fn lengths(&self) -> impl Iterator<Item = usize> {
        let taken = |bucket| if bucket == self.front as usize { self.next.len() } else { 0 };
        self.buckets.iter().enumerate().map(move |(bucket, list)| list.len() + taken(bucket))
    }

    /// Moves the entries of another queue into this one, ahead of its own in each bucket.
    pub(crate) fn append(&mut self, mut other: Self) {
        self.put_back();
        other.put_back();
        self.lowest = self.lowest.min(other.lowest);
        for (own, mut others) in self.buckets.iter_mut().zip(other.buckets) {
            own.append(&mut others);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn next(queue: &mut BucketQueue) -> Option<u32> {
        queue.pop().or_else(|| if queue.take(NONE, BATCH_LEN) { queue.pop() } else { None })
    }

    #[test]
    fn the_cheapest_bucket_comes_first_and_a_cheaper_one_cuts_in() {
        let mut queue = BucketQueue::default();
        for (v, cost) in [(0, 4.0), (1, 1e-3), (2, 100.0), (3, 0.0)] {
            queue.push(v, bucket(cost));
        }
        assert_eq!((next(&mut queue), next(&mut queue)), (Some(3), Some(1)));
        queue.push(7, bucket(1e-30));
        assert_eq!((next(&mut queue), next(&mut queue)), (Some(7), Some(0)));
        assert_eq!((next(&mut queue), next(&mut queue)), (Some(2), None));
    }

    #[test]
    fn buckets_are_last_in_first_out_and_a_batch_can_be_put_back() {
        let mut queue = BucketQueue::default();
        (0..BATCH_LEN as u32 + 3).for_each(|v| queue.push(v, 9));
        assert!(!queue.take(8, BATCH_LEN) && queue.take(9, BATCH_LEN));
        assert_eq!((queue.next().0.len(), queue.pop()), (BATCH_LEN, Some(18)));
        queue.put_back();
        queue.push(40, 4);
        let all: Vec<u32> = std::iter::from_fn(|| next(&mut queue)).collect();
        assert_eq!(all, [40].into_iter().chain((0..18).rev()).collect::<Vec<_>>());
    }

    #[test]
    fn infinite_and_nan_costs_are_not_queued() {
        let mut queue = BucketQueue::default();
        for cost in [f32::NAN, f32::INFINITY] {
            assert_eq!(bucket(cost), NONE);
            queue.push(0, bucket(cost));
        }
        assert!(!queue.take(NONE, BATCH_LEN));
    }

    #[test]
    fn an_octave_has_four_buckets() {
        assert_eq!(bucket(2.0) - bucket(1.0), 4);
        assert!(bucket(f32::MAX) < NONE && bucket(-1.0) == 0);
        assert_eq!([bucket(min_cost_in(77)), bucket(min_cost_in(77).next_down())], [77, 76]);
    }
}
