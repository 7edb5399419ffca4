//! Greedy strips in one pass, each as long as possible and beside the one before.

use meshlod_mesh::VertexId;

use crate::dual_node::DualEdge;
use crate::emit::Turn;
use crate::path_cover::PathCover;
use crate::strips::Strips;
use crate::verify::has_three_corners;

/// Number of nodes inspected in either direction before a strip is started. The bunny: 1.180
/// vertices per face with 1, 1.177 with 4, 1.174 with 8, 1.172 with 16, 1.173 with 40. A strip
/// looks in six directions, so 8 cost some nanoseconds per face.
const LOOK: usize = 8;

impl PathCover {
    /// Links the nodes, which must not be linked yet, and returns the strips in the order they are
    /// found.
    ///
    /// A strip starts in the direction in which it can go furthest without a swap, grows both ways
    /// until no free face is beside it, and swaps only where it would end. The next strip starts
    /// beside the last. Cost: O(nodes).
    pub(crate) fn cover_greedily(&mut self, faces: &[[VertexId; 3]]) -> Strips {
        let mut greedy =
            GreedyCover { taken: vec![false; faces.len()], near: Vec::new(), cover: self };
        let mut strips = Strips::default();
        let mut strip = Vec::new();
        for first in (0..faces.len()).filter(|&face| has_three_corners(&faces[face])) {
            let mut start = Some(first);
            while let Some(node) = start {
                if !greedy.taken[node] {
                    let ends = greedy.grow_strip(node);
                    let end = greedy.cover.better_end(ends[0], ends[1]);
                    greedy.cover.draw(faces, end, &mut strip);
                    strips.push(strip.drain(..));
                }
                start = greedy.near.pop().map(|node| node as usize);
            }
        }
        strips
    }
}

/// State of the greedy pass over a cover.
struct GreedyCover<'a> {
    cover: &'a mut PathCover,
    /// True for nodes that are in a strip.
    taken: Vec<bool>,
    /// Nodes beside strips, the most recent last.
    near: Vec<u32>,
}

impl GreedyCover<'_> {
    /// Grows a strip through a free node and returns its ends.
    fn grow_strip(&mut self, start: usize) -> [usize; 2] {
        self.taken[start] = true;
        let Some((side, turn)) = self.best_direction(start) else { return [start; 2] };
        let end = self.extend(DualEdge::new(start, side), turn);
        // Back from the start, first in the direction that needs no swap.
        let straight = turn.side(DualEdge::new(start, side));
        let bent = 3 - side - straight;
        if self.is_free(self.cover.across(DualEdge::new(start, straight))) {
            self.remember(DualEdge::new(start, bent));
            [end, self.extend(DualEdge::new(start, straight), turn.other())]
        } else if self.is_free(self.cover.across(DualEdge::new(start, bent))) {
            [end, self.extend(DualEdge::new(start, bent), turn)]
        } else {
            [end, start]
        }
    }

    /// Finds the side to leave a node by, and the turn in the next one, that give the longest strip
    /// both ways.
    fn best_direction(&self, start: usize) -> Option<(usize, Turn)> {
        let mut best = None;
        let mut most = 0;
        for side in 0..3 {
            let here = DualEdge::new(start, side);
            let entry = self.cover.across(here);
            if !self.is_free(entry) {
                continue;
            }
            for turn in [Turn::Next, Turn::Previous] {
                let back = self.cover.across(DualEdge::new(start, turn.side(here)));
                let length = self.straight(entry, turn) + self.straight(back, turn.other());
                if length > most {
                    (most, best) = (length, Some((side, turn)));
                }
            }
        }
        best
    }

    /// Counts the free nodes that follow without a swap, up to [`LOOK`].
    fn straight(&self, mut entry: DualEdge, mut turn: Turn) -> usize {
        for length in 0..LOOK {
            if !self.is_free(entry) {
                return length;
            }
            entry = self.cover.across(DualEdge::new(entry.node(), turn.side(entry)));
            turn = turn.other();
        }
        LOOK
    }

    /// Grows a strip through `edge`, whose far side is free, alternating turns from `turn` on, as
    /// far as it goes. Returns the last node.
    fn extend(&mut self, mut edge: DualEdge, mut turn: Turn) -> usize {
        loop {
            let entry = self.cover.across(edge);
            self.taken[entry.node()] = true;
            for edge in [edge, entry] {
                let links = &mut self.cover.nodes[edge.node()].links;
                *links = links.with(edge.side());
            }
            let ahead = |turn: Turn| DualEdge::new(entry.node(), turn.side(entry));
            if !self.is_free(self.cover.across(ahead(turn))) {
                turn = turn.other();
                if !self.is_free(self.cover.across(ahead(turn))) {
                    return entry.node();
                }
            }
            edge = ahead(turn);
            turn = turn.other();
            self.remember(ahead(turn));
        }
    }

    #[inline]
    fn is_free(&self, edge: DualEdge) -> bool {
        !edge.is_none() && !self.taken[edge.node()]
    }

    /// Queues the node beyond `edge` as a start if it is free.
    #[inline]
    fn remember(&mut self, edge: DualEdge) {
        let beside = self.cover.across(edge);
        if self.is_free(beside) {
            self.near.push(beside.node() as u32);
        }
    }
}
