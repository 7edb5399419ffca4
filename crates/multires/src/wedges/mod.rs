//! Wedges of all levels: which one a face has at a corner, in any cut, and their values.
//!
//! A contraction merges wedges as it merges vertices, so the wedges of all nodes form a forest of
//! their own: each belongs to a node, and its parent to the node above. A face of a cut has at each
//! corner the wedge of the active node that is above its wedge in the finest mesh, whatever is
//! refined elsewhere. Nodes without seams have one wedge, and then nothing is stored but its values:
//! only updates next to seams record which wedges their faces get. docs/notes/multires.md has more.

mod labels;
mod level;
mod pack;
mod record;
mod recorded_splits;
mod values;

pub(crate) use labels::WedgeLabels;
pub(crate) use level::LevelWedges;
pub(crate) use pack::DetachedWedges;
pub(crate) use record::{ForestWedges, WedgeRecorder, WedgeSplit};
pub(crate) use recorded_splits::{LOST, SplitRecord};
pub use values::LayerFormat;
pub(crate) use values::{WedgeNumbers, WedgeValues};

use self::labels::PackedLabels;
use self::recorded_splits::RecordedSplits;
use crate::pack::RankedSet;

/// Wedges of a packed model, numbered by node: first those of the roots, then those of the children
/// of update 0, of update 1…
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Wedges {
    of_nodes: NodeWedges,
    /// Wedges at the corners of the base mesh's faces.
    pub(crate) base: Vec<[u32; 3]>,
    splits: RecordedSplits,
    pub(crate) values: WedgeValues,
    pub(crate) labels: PackedLabels,
}

/// First wedge of each node. Only nodes of several wedges take memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct NodeWedges {
    several: RankedSet,
    /// Number of wedges beyond the first of each node, before each node of several and in the end.
    extra: Vec<u32>,
}

impl NodeWedges {
    /// Numbers the wedges of nodes that have these numbers of them, each at least one.
    pub(crate) fn new(counts: impl Iterator<Item = u32>) -> Self {
        let (mut several, mut extra) = (RankedSet::default(), vec![0]);
        for (node, count) in (0..).zip(counts).filter(|&(_, count)| count > 1) {
            several.push(node);
            extra.push(extra[extra.len() - 1] + count - 1);
        }
        Self { several, extra }
    }

    /// Returns the first wedge of a node, or for the number of nodes that of all wedges.
    #[inline]
    pub(crate) fn first(&self, node: u32) -> u32 {
        node + self.extra.get(self.several.below(node)).copied().unwrap_or(0)
    }

    /// Returns the number of wedges of a node.
    #[inline]
    pub(crate) fn count(&self, node: u32) -> u32 {
        self.several.rank(node).map_or(1, |rank| 1 + self.extra[rank + 1] - self.extra[rank])
    }

    fn bytes(&self) -> usize {
        self.several.bytes() + size_of_val(&self.extra[..])
    }
}

impl Wedges {
    /// Returns the first wedge of a node.
    #[inline]
    pub(crate) fn first(&self, node: u32) -> u32 {
        self.of_nodes.first(node)
    }

    /// Returns the wedges of a node.
    #[inline]
    pub(crate) fn of(&self, node: u32) -> std::ops::Range<u32> {
        let first = self.of_nodes.first(node);
        first..first + self.of_nodes.count(node)
    }

    /// Returns a wedge of a node by its local number, which may be out of range in an uncertified
    /// file.
    #[inline]
    pub(crate) fn at(&self, node: u32, local: u16) -> u32 {
        match local {
            0 => self.first(node),
            _ => self.first(node) + u32::from(local).min(self.count(node) - 1),
        }
    }

    /// Returns the number of wedges of a node.
    #[inline]
    pub(crate) fn count(&self, node: u32) -> u32 {
        self.of_nodes.count(node)
    }

    /// Returns true if a face over the given nodes may have the wedges: they are of its nodes, all of
    /// one material and object.
    pub(crate) fn may_be_at(&self, wedges: [u32; 3], nodes: [u32; 3]) -> bool {
        let is_own = |k: usize| {
            self.of(nodes[k]).contains(&wedges[k])
                && self.labels.of(wedges[k]) == self.labels.of(wedges[0])
        };
        (0..3).all(is_own)
    }

    /// Returns the record of an update, given its children and the number of faces that it creates;
    /// `None` if each child has one wedge and created faces continue those around.
    #[inline]
    pub(crate) fn split(
        &self,
        update: u32,
        children: [u32; 2],
        created: impl FnOnce() -> usize,
    ) -> Option<SplitRecord<'_>> {
        let wedges = || children.map(|child| self.count(child)).iter().sum();
        self.splits.get(update, wedges, created)
    }

    /// Returns the numbers of an update's record.
    pub(crate) fn record(&self, update: u32) -> Option<Vec<u16>> {
        Some(self.splits.numbers(update)?.collect())
    }

    /// Returns true if an update has a record.
    pub(crate) fn is_recorded(&self, update: u32) -> bool {
        self.splits.contains(update)
    }

    /// Returns the number of wedges of all nodes.
    pub(crate) fn wedge_count(&self) -> usize {
        self.values.wedge_count()
    }

    /// Returns the memory used, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.of_nodes.bytes()
            + size_of_val(&self.base[..])
            + self.splits.bytes()
            + self.values.bytes()
            + self.labels.bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_of_one_wedge_take_no_number_of_their_own() {
        let counts = [1, 3, 1, 1, 2, 1];
        let all = NodeWedges::new(counts.into_iter());
        let firsts: Vec<u32> = (0..=6).map(|node| all.first(node)).collect();
        assert_eq!(firsts, [0, 1, 4, 5, 6, 8, 9]);
        assert!((0..6).all(|node| all.count(node) == counts[node as usize]));
        assert_eq!(NodeWedges::default().first(7), 7);
    }
}
