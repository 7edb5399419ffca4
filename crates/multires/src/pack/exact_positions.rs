//! Exact input positions, for those nodes of a model that have one.

use std::sync::Arc;

use super::RankedSet;

/// Exact positions of some nodes in model units, or a note that the model keeps none. A
/// rank-indexed bit set finds them at two bits per node. Clones share the table.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ExactPositions(Option<Arc<Table>>);

#[derive(Clone, Debug, Default, PartialEq)]
struct Table {
    nodes: RankedSet,
    /// Positions of the nodes that have one, by rising node.
    positions: Vec<[f64; 3]>,
}

impl ExactPositions {
    /// Creates the table of a lossless model, still empty.
    pub(crate) fn lossless() -> Self {
        Self(Some(Arc::default()))
    }

    /// Returns true if the model is lossless, even if the table is empty.
    pub(crate) fn is_lossless(&self) -> bool {
        self.0.is_some()
    }

    /// Adds the position of a node; nodes must come in rising order.
    pub(crate) fn push(&mut self, node: u32, position: [f64; 3]) {
        let Table { nodes, positions } = Arc::make_mut(self.0.get_or_insert_default());
        nodes.push(node);
        positions.push(position);
    }

    /// Returns the exact position of a node, if it has one.
    #[inline]
    pub(crate) fn get(&self, node: u32) -> Option<[f64; 3]> {
        let Table { nodes, positions } = &**self.0.as_ref()?;
        nodes.rank(node).map(|rank| positions[rank])
    }

    /// Returns the positions of the listed nodes, renumbered by their indices in the list.
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

    /// Returns the memory used.
    pub(crate) fn bytes(&self) -> usize {
        let bytes = |table: &Arc<Table>| table.nodes.bytes() + size_of_val(&table.positions[..]);
        self.0.as_ref().map_or(0, bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_node_has_its_own_position() {
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
    fn an_empty_table_is_still_lossless() {
        let mut exact = ExactPositions::lossless();
        exact.push(7, [1.0; 3]);
        assert!(
            exact.select([1, 2]).is_lossless()
                && !ExactPositions::default().select([7]).is_lossless()
        );
        assert_eq!((exact.select([1, 2]).get(0), ExactPositions::default().get(7)), (None, None));
        // Two bits per node: 16 bytes for 64.
        exact.push(1023, [2.0; 3]);
        assert_eq!(exact.bytes(), 2 * 24 + 1024 / 4);
    }
}
