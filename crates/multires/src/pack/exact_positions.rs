//! Positions as they were given, to the bit, of the nodes that have one.

use std::sync::Arc;

/// The positions of some nodes in model units, or word that none is kept. A node has one or it has none:
/// for each there are two bits that say so, and where its position is. Copies share the room.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ExactPositions(Option<Arc<Table>>);

#[derive(Clone, Debug, Default, PartialEq)]
struct Table {
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

impl ExactPositions {
    /// Where positions are kept, of no node yet.
    pub(crate) fn lossless() -> Self {
        Self(Some(Arc::default()))
    }

    /// Whether positions are kept, if only of nodes that are not here: whether a model is lossless.
    pub(crate) fn is_lossless(&self) -> bool {
        self.0.is_some()
    }

    /// Adds the position of a node; nodes come by rising numbers.
    pub(crate) fn push(&mut self, node: u32, position: [f64; 3]) {
        let (block, bit) = place(node);
        let Table { blocks, positions } = Arc::make_mut(self.0.get_or_insert_default());
        debug_assert!(blocks.len() <= block + 1, "node {node} comes late");
        let before = positions.len() as u32;
        blocks.resize(blocks.len().max(block + 1), Block { nodes: 0, before });
        debug_assert!(blocks[block].nodes < bit, "node {node} comes late");
        blocks[block].nodes |= bit;
        positions.push(position);
    }

    /// Where a node is, if it has a position.
    #[inline]
    pub(crate) fn get(&self, node: u32) -> Option<[f64; 3]> {
        let Table { blocks, positions } = &**self.0.as_ref()?;
        let (block, bit) = place(node);
        let Block { nodes, before } = *blocks.get(block)?;
        let rank = before + (nodes & (bit - 1)).count_ones();
        (nodes & bit != 0).then(|| positions[rank as usize])
    }

    /// The positions of a list of nodes, by their places in the list.
    pub(crate) fn select(&self, nodes: impl IntoIterator<Item = u32>) -> Self {
        if !self.is_lossless() {
            return Self::default();
        }
        let mut selected = Self::lossless();
        for (at, node) in (0..).zip(nodes) {
            if let Some(position) = self.get(node) {
                selected.push(at, position);
            }
        }
        selected
    }

    /// What it takes in memory.
    pub(crate) fn bytes(&self) -> usize {
        let bytes =
            |table: &Arc<Table>| size_of_val(&table.blocks[..]) + size_of_val(&table.positions[..]);
        self.0.as_ref().map_or(0, bytes)
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
        let mut exact = ExactPositions::default();
        (0..1000).filter(|&node| is_there(node)).for_each(|node| exact.push(node, position(node)));
        for node in 0..2000 {
            let expected = (node < 1000 && is_there(node)).then(|| position(node));
            assert_eq!(exact.get(node), expected, "{node}");
        }
        let selected = exact.select([3, 994, 0, 203, 5000, 7]);
        let expected = [None, Some(994), Some(0), None, None, Some(7), None];
        for (at, node) in (0..).zip(expected) {
            assert_eq!(selected.get(at), node.map(position));
        }
    }

    #[test]
    fn what_keeps_no_position_yet_keeps_them_still() {
        let mut exact = ExactPositions::lossless();
        exact.push(7, [1.0; 3]);
        assert!(
            exact.select([1, 2]).is_lossless()
                && !ExactPositions::default().select([7]).is_lossless()
        );
        assert_eq!((exact.select([1, 2]).get(0), ExactPositions::default().get(7)), (None, None));
        // 64 nodes are 16 bytes.
        exact.push(1023, [2.0; 3]);
        assert_eq!(exact.bytes(), 2 * 24 + 1024 / 4);
    }
}
