//! Disjoint sets of numbers (union-find).

/// Disjoint sets of numbers, each represented by its least number.
#[derive(Default)]
pub(crate) struct UnionFind(Vec<u32>);

impl UnionFind {
    /// Creates one set for each number below `count`.
    pub(crate) fn new(count: usize) -> Self {
        let mut sets = Self::default();
        sets.reset(count);
        sets
    }

    /// Resets to one set for each number below `count`, keeping the memory.
    pub(crate) fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.extend(0..count as u32);
    }

    /// Joins the sets of two numbers; returns false if both are already in one set.
    pub(crate) fn union(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
        a != b
    }

    /// Returns the representative of a number's set, which is its least number.
    pub(crate) fn find(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            // Path halving.
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }
}
