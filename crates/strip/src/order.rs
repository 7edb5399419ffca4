//! Breadth-first order of faces, which brings neighbours close to each other in memory.

use crate::dual_node::{DualEdge, DualNode};
use crate::path_cover::PathCover;

/// Faces in breadth-first order of the dual graph.
pub(crate) struct Order {
    /// The faces in this order.
    pub(crate) faces: Vec<u32>,
    /// Largest number of faces at one distance.
    pub(crate) widest: usize,
}

impl Order {
    /// Traverses each component breadth first from its first face.
    ///
    /// A run of this order longer than `widest` has neighbours only in the runs before and after
    /// it.
    pub(crate) fn new(cover: &PathCover) -> Self {
        let count = cover.nodes.len();
        let mut faces = Vec::with_capacity(count);
        let mut reached = vec![false; count];
        let mut widest = 0;
        for first in 0..count {
            if std::mem::replace(&mut reached[first], true) {
                continue;
            }
            let mut ring = faces.len();
            faces.push(first as u32);
            while ring < faces.len() {
                let next = faces.len();
                widest = widest.max(next - ring);
                for at in ring..next {
                    for edge in cover.nodes[faces[at] as usize].across {
                        if !edge.is_none() && !std::mem::replace(&mut reached[edge.node()], true) {
                            faces.push(edge.node() as u32);
                        }
                    }
                }
                ring = next;
            }
        }
        Self { faces, widest }
    }

    /// Sorts per-face values into this order.
    pub(crate) fn sorted<T: Copy>(&self, things: &[T]) -> Vec<T> {
        self.faces.iter().map(|&face| things[face as usize]).collect()
    }

    /// Sorts a cover into this order.
    pub(crate) fn sort(&self, cover: &PathCover) -> PathCover {
        let mut place = vec![0; self.faces.len()];
        for (at, &face) in self.faces.iter().enumerate() {
            place[face as usize] = at as u32;
        }
        let moved = |edge: DualEdge| match edge.is_none() {
            true => edge,
            false => DualEdge::new(place[edge.node()] as usize, edge.side()),
        };
        let node = |node: DualNode| DualNode { across: node.across.map(moved), ..node };
        let nodes = self.sorted(&cover.nodes).into_iter().map(node).collect();
        PathCover { nodes, touched: None }
    }
}
