//! A path cover of the dual graph: which neighbouring faces a strip draws one after the other.
//!
//! Faces are the *nodes* of the dual graph, and the sides of faces its edges. Each node is linked
//! to at most two others. Linked nodes form paths, and each path becomes a strip. The cover is one
//! array of 16 bytes per face: an annealing move reads and writes half a dozen nodes, so its cost
//! is the number of cache lines they touch.

use meshlod_mesh::VertexId;

use crate::dual::nodes;
use crate::dual_node::{DualEdge, DualNode};
use crate::touched::Touched;

/// A path cover of the dual graph of some faces.
///
/// Invariants: both ends of a link agree on it, no node has more than two links, and no path is
/// closed.
#[derive(Clone, Debug)]
pub(crate) struct PathCover {
    pub(crate) nodes: Vec<DualNode>,
    /// Nodes whose paths have changed, if they are to be listed. Runs that are annealed in parallel
    /// list none.
    pub(crate) touched: Option<Touched>,
}

impl PathCover {
    /// Builds a cover in which every face is a path by itself.
    pub(crate) fn new(faces: &[[VertexId; 3]]) -> Self {
        Self { nodes: nodes(faces), touched: None }
    }

    /// Disconnects faces with different labels, so that no strip crosses from one label to another.
    ///
    /// # Panics
    /// If there is not one label per face.
    pub(crate) fn split_by_labels(&mut self, labels: &[u32]) {
        assert_eq!(labels.len(), self.nodes.len(), "one label per face");
        for (node, label) in labels.iter().enumerate() {
            for side in 0..3 {
                let other = self.nodes[node].across[side];
                if !other.is_none() && labels[other.node()] != *label {
                    self.disconnect(DualEdge::new(node, side));
                }
            }
        }
    }

    /// Returns the opposite edge, [`DualEdge::NONE`] on a boundary.
    #[inline]
    pub(crate) fn across(&self, edge: DualEdge) -> DualEdge {
        self.nodes[edge.node()].across[edge.side()]
    }

    /// Disconnects the two faces at an edge, and removes their link if there is one.
    pub(crate) fn disconnect(&mut self, edge: DualEdge) {
        let other = self.across(edge);
        for edge in [edge, other].into_iter().filter(|edge| !edge.is_none()) {
            let node = &mut self.nodes[edge.node()];
            node.links = node.links.without(edge.side());
            node.across[edge.side()] = DualEdge::NONE;
        }
    }

    /// Connects two sides without linking them; each is disconnected from its former neighbour.
    pub(crate) fn connect(&mut self, p: DualEdge, q: DualEdge) {
        self.disconnect(p);
        self.disconnect(q);
        self.nodes[p.node()].across[p.side()] = q;
        self.nodes[q.node()].across[q.side()] = p;
    }

    /// Links the nodes at both ends of an edge if both have fewer than two links and no path
    /// closes. Returns whether they are linked now.
    pub(crate) fn link(&mut self, edge: DualEdge) -> bool {
        let other = self.across(edge);
        if other.is_none() || self.nodes[edge.node()].links.has(edge.side()) {
            return !other.is_none();
        }
        if !self.is_end(edge.node()) || !self.is_end(other.node()) || self.same_path(edge, other) {
            return false;
        }
        for edge in [edge, other] {
            let node = &mut self.nodes[edge.node()];
            node.links = node.links.with(edge.side());
        }
        true
    }

    /// Removes the link across an edge.
    pub(crate) fn unlink(&mut self, edge: DualEdge) {
        for edge in [edge, self.across(edge)] {
            let node = &mut self.nodes[edge.node()];
            node.links = node.links.without(edge.side());
        }
    }

    /// Returns whether two nodes, both ends of paths, end the same path. Cost: the length of the
    /// shorter path.
    fn same_path(&self, p: DualEdge, q: DualEdge) -> bool {
        let (mut from_p, mut from_q) = (self.path(p.node()), self.path(q.node()));
        let (mut end_p, mut end_q) = (p.node(), q.node());
        loop {
            match from_p.next() {
                Some((node, _)) => end_p = node,
                None => return end_p == q.node(),
            }
            match from_q.next() {
                Some((node, _)) => end_q = node,
                None => return end_q == p.node(),
            }
        }
    }

    /// Links consecutive nodes of `path` wherever they are neighbours and [`PathCover::link`]
    /// allows it.
    pub(crate) fn link_sequence(&mut self, path: impl IntoIterator<Item = usize>) {
        let mut path = path.into_iter();
        let Some(mut before) = path.next() else { return };
        for node in path {
            let to = |side: &usize| {
                let other = self.nodes[before].across[*side];
                !other.is_none() && other.node() == node
            };
            if let Some(side) = (0..3).find(to) {
                self.link(DualEdge::new(before, side));
            }
            before = node;
        }
    }

    /// Walks a path from its end `end`: each node with the side the path leaves it by, `None` at
    /// the far end.
    pub(crate) fn path(&self, end: usize) -> impl Iterator<Item = (usize, Option<usize>)> + '_ {
        debug_assert!(self.nodes[end].links.count() < 2, "paths are walked from their ends");
        let mut next = Some((end, self.nodes[end].links));
        std::iter::from_fn(move || {
            let (node, onward) = next?;
            let side = onward.first();
            next = side.map(|side| {
                let entry = self.nodes[node].across[side];
                (entry.node(), self.nodes[entry.node()].links.without(entry.side()))
            });
            Some((node, side))
        })
    }

    /// Returns an end of the path through a node. Cost: the length of the path.
    pub(crate) fn end_of(&self, node: usize) -> usize {
        let Some(side) = self.nodes[node].links.first() else { return node };
        let mut entry = self.nodes[node].across[side];
        while let Some(side) = self.nodes[entry.node()].links.without(entry.side()).first() {
            entry = self.nodes[entry.node()].across[side];
        }
        entry.node()
    }

    /// Returns whether a node ends a path.
    #[inline]
    pub(crate) fn is_end(&self, node: usize) -> bool {
        self.nodes[node].links.count() < 2
    }
}

#[cfg(test)]
impl PathCover {
    /// Panics if an invariant is violated.
    pub(crate) fn check(&self) {
        let mut on_paths = 0;
        for (c, node) in self.nodes.iter().enumerate() {
            assert!(node.links.count() <= 2);
            for side in 0..3 {
                let other = node.across[side];
                assert!(!other.is_none() || !node.links.has(side));
                if !other.is_none() {
                    assert_eq!(self.across(other), DualEdge::new(c, side));
                    let linked = self.nodes[other.node()].links.has(other.side());
                    assert_eq!(linked, node.links.has(side));
                }
            }
            if self.is_end(c) {
                let length = self.path(c).count();
                // A path of two nodes or more is visited from both ends.
                on_paths += if length == 1 { 2 } else { length };
            }
        }
        assert_eq!(on_paths, 2 * self.nodes.len(), "a path is closed");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Builds six faces around a vertex.
    fn wheel() -> Vec<[VertexId; 3]> {
        (0..6).map(|i| [0, i + 1, (i + 1) % 6 + 1].map(VertexId)).collect()
    }

    #[test]
    fn a_ring_of_faces_is_never_closed() {
        let mut cover = PathCover::new(&wheel());
        cover.link_sequence([0, 1, 2, 3, 4, 5, 0]);
        cover.check();
        assert_eq!(cover.path(0).map(|(node, _)| node).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn no_path_crosses_between_labels() {
        let mut cover = PathCover::new(&wheel());
        cover.link_sequence(0..6);
        cover.split_by_labels(&[0, 0, 1, 1, 1, 2]);
        cover.link_sequence(0..6);
        cover.check();
        let lengths: Vec<_> = [0, 2, 5].map(|end| cover.path(end).count()).into();
        assert_eq!(lengths, [2, 3, 1]);
    }

    #[test]
    fn what_is_severed_can_be_joined_again() {
        let mut cover = PathCover::new(&wheel());
        let edge = (0..3).map(|side| DualEdge::new(0, side)).find(|p| !cover.across(*p).is_none());
        let edge = edge.unwrap();
        let other = cover.across(edge);
        assert!(cover.link(edge));
        cover.disconnect(edge);
        assert!(!cover.link(edge));
        cover.connect(edge, other);
        assert!(cover.link(edge));
        cover.check();
    }
}
