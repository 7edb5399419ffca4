//! Positions as they were given, to the bit, of the nodes that have one.

/// The positions of some nodes in model units. A node has one or it has none: there is no room for those
/// that have none but a bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Exact {
    /// By 64 nodes.
    blocks: Vec<Block>,
    /// Of those that have one, in the order of their numbers.
    positions: Vec<[f64; 3]>,
}

/// Which of 64 nodes have a position.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Block {
    /// A bit each.
    nodes: u64,
    /// How many nodes before them have one.
    before: u32,
}

impl Exact {
    /// Adds the position of a node; nodes come by rising numbers.
    pub(crate) fn push(&mut self, node: u32, position: [f64; 3]) {
        let (block, bit) = place(node);
        let before = self.positions.len() as u32;
        self.blocks.resize(self.blocks.len().max(block + 1), Block { nodes: 0, before });
        self.blocks[block].nodes |= bit;
        self.positions.push(position);
    }

    /// Where a node is, if it has a position.
    #[inline]
    pub(crate) fn of(&self, node: u32) -> Option<[f64; 3]> {
        let (block, bit) = place(node);
        let Block { nodes, before } = *self.blocks.get(block)?;
        let rank = before + (nodes & (bit - 1)).count_ones();
        (nodes & bit != 0).then(|| self.positions[rank as usize])
    }

    /// Takes the positions of a list of nodes, by their places in the list.
    pub(crate) fn pick(&mut self, from: &Self, nodes: impl IntoIterator<Item = u32>) {
        self.clear();
        if from.is_empty() {
            return;
        }
        for (at, node) in (0..).zip(nodes) {
            if let Some(position) = from.of(node) {
                self.push(at, position);
            }
        }
    }

    /// The positions of a list of nodes, by their places in the list.
    pub(crate) fn picked(&self, nodes: impl IntoIterator<Item = u32>) -> Self {
        let mut picked = Self::default();
        picked.pick(self, nodes);
        picked
    }

    /// Forgets all and keeps the room.
    pub(crate) fn clear(&mut self) {
        self.blocks.clear();
        self.positions.clear();
    }

    /// Whether no node has a position.
    pub(crate) fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// What it takes in memory.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.blocks[..]) + size_of_val(&self.positions[..])
    }
}

/// The block of a node, and its bit there.
fn place(node: u32) -> (usize, u64) {
    (node as usize / 64, 1 << (node % 64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn those_that_have_a_position_have_their_own() {
        let is_there = |node: u32| node.is_multiple_of(7) && !(200..500).contains(&node);
        let position = |node: u32| [f64::from(node), -0.0, f64::from_bits(node.into())];
        let mut exact = Exact::default();
        (0..1000).filter(|&node| is_there(node)).for_each(|node| exact.push(node, position(node)));
        for node in 0..2000 {
            let expected = (node < 1000 && is_there(node)).then(|| position(node));
            assert_eq!(exact.of(node), expected, "{node}");
        }
        let picked = exact.picked([3, 994, 0, 203, 5000, 7]);
        let expected = [None, Some(994), Some(0), None, None, Some(7), None];
        for (at, node) in (0..).zip(expected) {
            assert_eq!(picked.of(at), node.map(position));
        }
        assert!(exact.picked([1, 2]).is_empty() && !picked.is_empty());
    }
}
