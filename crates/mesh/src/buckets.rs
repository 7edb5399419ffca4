//! Counting sort of indices into buckets, stored in two flat arrays.

/// Indices `0..n` grouped into buckets, in ascending order within each.
#[derive(Clone, Debug)]
pub struct Buckets {
    /// Start of each bucket in `members`, and the end of the last.
    starts: Vec<u32>,
    members: Vec<u32>,
}

impl Buckets {
    /// Groups the indices `0..n` into `count` buckets; item `i` of `of_members` is the bucket of
    /// index `i`.
    ///
    /// Cost: O(count + members).
    pub fn new(
        count: usize,
        of_members: impl DoubleEndedIterator<Item = usize> + ExactSizeIterator + Clone,
    ) -> Self {
        let mut starts = vec![0_u32; count + 1];
        for bucket in of_members.clone() {
            starts[bucket] += 1;
        }
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        // Filled from the back: each start is counted down from the end of its bucket.
        let mut members = vec![0; of_members.len()];
        for (member, bucket) in of_members.enumerate().rev() {
            starts[bucket] -= 1;
            members[starts[bucket] as usize] = member as u32;
        }
        Self { starts, members }
    }

    /// Returns the indices in a bucket, in ascending order.
    #[inline]
    pub fn of(&self, bucket: usize) -> &[u32] {
        &self.members[self.starts[bucket] as usize..self.starts[bucket + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_keep_their_order() {
        let buckets = Buckets::new(4, [2, 0, 2, 3, 0].into_iter());
        let all: Vec<&[u32]> = (0..4).map(|bucket| buckets.of(bucket)).collect();
        assert_eq!(all, [&[1, 4][..], &[], &[0, 2], &[3]]);
    }
}
