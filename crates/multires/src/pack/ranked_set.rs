//! Set of numbers that tells how many of its members are below a number.

/// Set of 32-bit numbers with ranks, at two bits per number up to the greatest member.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct RankedSet {
    /// One block per 64 numbers.
    blocks: Vec<Block>,
    len: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Block {
    /// Set bits mark the members.
    members: u64,
    /// Number of members before this block.
    before: u32,
}

impl RankedSet {
    /// Adds a number; numbers must come in rising order.
    pub(crate) fn push(&mut self, number: u32) {
        let (block, bit) = place(number);
        let before = self.len;
        debug_assert!(self.blocks.len() <= block + 1, "{number} comes late");
        self.blocks.resize(self.blocks.len().max(block + 1), Block { members: 0, before });
        debug_assert!(self.blocks[block].members < bit, "{number} comes late");
        self.blocks[block].members |= bit;
        self.len += 1;
    }

    /// Returns the number of members.
    #[inline]
    pub(crate) fn len(&self) -> usize {
        self.len as usize
    }

    /// Returns the number of members below a number.
    #[inline]
    pub(crate) fn below(&self, number: u32) -> usize {
        let (block, bit) = place(number);
        self.blocks.get(block).map_or(self.len(), |block| {
            (block.before + (block.members & (bit - 1)).count_ones()) as usize
        })
    }

    /// Returns the number of members below a member; `None` if the number is not in the set.
    #[inline]
    pub(crate) fn rank(&self, number: u32) -> Option<usize> {
        let (block, bit) = place(number);
        let is_member = self.blocks.get(block).is_some_and(|block| block.members & bit != 0);
        is_member.then(|| self.below(number))
    }

    /// Returns the memory used.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.blocks[..])
    }
}

/// Returns the block of a number and its bit there.
#[inline]
fn place(number: u32) -> (usize, u64) {
    (number as usize / 64, 1 << (number % 64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_are_counted() {
        let is_member = |number: &u32| number.is_multiple_of(7) && !(200..500).contains(number);
        let mut set = RankedSet::default();
        (0..1000).filter(is_member).for_each(|number| set.push(number));
        for number in 0..2000 {
            let below = (0..number.min(1000)).filter(is_member).count();
            let rank = (number < 1000 && is_member(&number)).then_some(below);
            assert_eq!((set.below(number), set.rank(number)), (below, rank), "{number}");
        }
        assert_eq!((set.len(), RankedSet::default().below(5)), (set.below(1000), 0));
    }
}
