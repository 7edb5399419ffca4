//! Disjoint sets of numbers (union-find).

/// Disjoint sets of numbers, each represented by its least number.
#[derive(Clone, Debug, Default)]
pub struct UnionFind(Vec<u32>);

impl UnionFind {
    /// Creates one set for each number below `count`.
    pub fn new(count: usize) -> Self {
        let mut sets = Self::default();
        sets.reset(count);
        sets
    }

    /// Resets to one set for each number below `count`, keeping the memory.
    pub fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.extend(0..count as u32);
    }

    /// Joins the sets of two numbers; returns false if both are already in one set.
    ///
    /// Cost: O(log n) amortized, n = numbers.
    ///
    /// # Panics
    /// If a number is not below the count.
    #[inline]
    pub fn union(&mut self, a: u32, b: u32) -> bool {
        // Most pairs of a mesh are joined already, and few paths are longer than one step.
        if self.0[a as usize] == self.0[b as usize] {
            return false;
        }
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
        a != b
    }

    /// Returns the representative of a number's set, which is its least number.
    ///
    /// Cost: O(log n) amortized, n = numbers.
    ///
    /// # Panics
    /// If the number is not below the count.
    #[inline]
    pub fn find(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            // Halving the path keeps later walks short.
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_number_represents_its_set() {
        let mut sets = UnionFind::new(6);
        assert!(sets.union(4, 5) && sets.union(2, 4) && sets.union(1, 3));
        assert!(!sets.union(5, 2) && !sets.union(3, 3));
        assert_eq!([0, 1, 2, 3, 4, 5].map(|i| sets.find(i)), [0, 1, 2, 1, 2, 2]);
        assert!(sets.union(3, 5));
        assert_eq!([1, 2, 3, 4, 5].map(|i| sets.find(i)), [1; 5]);
        sets.reset(2);
        assert_eq!([0, 1].map(|i| sets.find(i)), [0, 1]);
    }
}
