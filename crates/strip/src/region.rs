//! Region of a path cover whose links are changed step by step, with the cost of each step.

use crate::dual_node::{DualEdge, DualNode, Links};
use crate::energy::{Energy, swaps};
use crate::touched::Touched;

/// A run of consecutive nodes of a cover. Nodes with a neighbour outside must be frozen: then the
/// cost of a change depends only on nodes inside, and adjacent regions can be changed in parallel.
pub(crate) struct Region<'a> {
    nodes: &'a mut [DualNode],
    /// Index of the first of `nodes` in the cover.
    first: usize,
    energy: &'a Energy,
    /// Gets the nodes whose links change, if anybody wants to know.
    touched: Option<&'a mut Touched>,
}

/// Limit on walking a path each way to find its end. The bunny, 60 moves per face: 1.0941 vertices
/// per face in 1.1 s with 256, 1.0927 in 1.4 s with 1024. A ribbon of 4,000 faces in one path takes
/// 1.7 s and 6.4 s, and quadratic time without a limit.
const MAX_WALK: usize = 256;

impl<'a> Region<'a> {
    pub(crate) fn new(nodes: &'a mut [DualNode], first: usize, energy: &'a Energy) -> Self {
        Self { nodes, first, energy, touched: None }
    }

    /// Lists the nodes whose links change.
    pub(crate) fn touching(self, touched: Option<&'a mut Touched>) -> Self {
        Self { touched, ..self }
    }

    /// Records that the links at `edges` have changed for good.
    #[inline]
    pub(crate) fn touch(&mut self, edges: &[DualEdge]) {
        let Self { nodes, first, touched: Some(touched), .. } = self else { return };
        for edge in edges {
            let across = nodes[edge.node() - *first].across[edge.side()];
            touched.mark(edge.node());
            touched.mark(across.node());
        }
    }

    /// Returns the nodes of the region.
    pub(crate) fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.nodes.len()
    }

    #[inline]
    pub(crate) fn node(&self, node: usize) -> &DualNode {
        &self.nodes[node - self.first]
    }

    #[inline]
    pub(crate) fn links(&self, node: usize) -> Links {
        self.node(node).links
    }

    #[inline]
    pub(crate) fn across(&self, edge: DualEdge) -> DualEdge {
        self.node(edge.node()).across[edge.side()]
    }

    /// Returns whether a tunnel of this cost may still come down to `limit`.
    #[inline]
    pub(crate) fn can_pay(&self, cost: i32, limit: i32) -> bool {
        cost <= limit + self.energy.max_regain()
    }

    /// Toggles the link at `p` and returns the change in cost.
    #[inline]
    pub(crate) fn toggle(&mut self, p: DualEdge) -> i32 {
        let q = self.across(p);
        let (of_p, of_q) = (self.links(p.node()), self.links(q.node()));
        let made = !of_p.has(p.side());
        let link = self.energy.link(p, of_p.with(p.side()), q, of_q.with(q.side()));
        let cost = self.beside(p) + self.beside(q) + if made { link } else { -link };
        self.flip(p);
        cost
    }

    /// Toggles the link at `p` without computing the cost.
    #[inline]
    pub(crate) fn flip(&mut self, p: DualEdge) {
        for edge in [p, self.across(p)] {
            let links = &mut self.nodes[edge.node() - self.first].links;
            *links = links.toggled(edge.side());
        }
    }

    /// Returns whether a node ends a path or is next to a swap.
    pub(crate) fn is_defect(&self, node: usize) -> bool {
        let links = self.links(node);
        let swaps = |side| {
            let here = DualEdge::new(node, side);
            let there = self.across(here);
            swaps(here, links, there, self.links(there.node()))
        };
        links.count() < 2 || (0..3).any(|side| links.has(side) && swaps(side))
    }

    /// Returns the change in cost of a node and its other link when `p` is toggled.
    #[inline]
    fn beside(&self, p: DualEdge) -> i32 {
        let node = self.node(p.node());
        let (old, new) = (node.links, node.links.toggled(p.side()));
        let cost = self.energy.node(new) - self.energy.node(old);
        let Some(side) = old.without(p.side()).first() else { return cost };
        let here = DualEdge::new(p.node(), side);
        let there = node.across[side];
        let of_there = self.links(there.node());
        cost + self.energy.link(here, new, there, of_there)
            - self.energy.link(here, old, there, of_there)
    }

    /// Returns whether the path through the link at `p` is known to end. False if it closes, leaves
    /// the region both ways, or is longer than [`MAX_WALK`] both ways: such a long path need not
    /// change here.
    pub(crate) fn ends(&self, p: DualEdge) -> bool {
        let q = self.across(p);
        // Walk both ways at once, so that the nearer end decides.
        let (mut ahead, mut behind) = (Some(p), Some(q));
        for _ in 0..MAX_WALK {
            for (walker, start) in [(&mut ahead, q), (&mut behind, p)] {
                let Some(entry) = *walker else { continue };
                let node = self.node(entry.node());
                let Some(side) = node.links.without(entry.side()).first() else { return true };
                let next = node.across[side];
                if next.node() == start.node() {
                    return false;
                }
                *walker = Some(next).filter(|next| self.range().contains(&next.node()));
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use meshlod_mesh::VertexId;

    use super::*;
    use crate::energy::Prices;
    use crate::path_cover::PathCover;

    #[test]
    fn an_end_is_looked_for_no_further_than_it_pays() {
        // An open ribbon.
        let faces: Vec<_> = (0..3000u32)
            .map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] })
            .map(|face| face.map(VertexId))
            .collect();
        let mut cover = PathCover::new(&faces);
        cover.link_sequence(0..3000);
        let energy = Energy::new(&Prices::default());
        let link = |node: usize, cover: &PathCover| {
            DualEdge::new(node, cover.nodes[node].links.first().unwrap())
        };
        let edges = [10, 1500, 2990].map(|node| link(node, &cover));
        let region = Region::new(&mut cover.nodes, 0, &energy);
        assert_eq!(edges.map(|edge| region.ends(edge)), [true, false, true]);
    }
}
