//! Refinement by request instead of by a query.

use super::Cut;
use super::front::{Front, VertexState};
use crate::query::Limits;

impl Cut<'_> {
    /// Splits the vertex of the highest level of each triangle, with all that this depends on, and
    /// returns the number of splits.
    ///
    /// Triangles are given by nodes of this cut or below it; each node stands for the vertex that
    /// shows it. A triangle of three vertices of the finest mesh stays as it is. The next query starts
    /// afresh.
    pub fn refine_at(&mut self, triangles: impl IntoIterator<Item = [u32; 3]>) -> usize {
        self.begin_requests();
        let (mut stack, mut splits) = (Vec::new(), 0);
        for triangle in triangles {
            let mt = self.front.mt;
            let shown = triangle.map(|node| self.front.shown_by(node));
            let updates = shown.into_iter().filter_map(|node| mt.update_of(node));
            if let Some(highest) = updates.max_by_key(|&update| (mt.level(update), update)) {
                splits += self.front.force(highest, &mut stack);
            }
        }
        splits
    }

    /// Splits every vertex, as long as there are any, where a point of the focus may be compared
    /// with its surroundings; returns the number of splits. The next query starts afresh.
    pub fn refine_all_around(&mut self, limits: &Limits) -> usize {
        self.begin_requests();
        let mt = self.front.mt;
        let mut nodes: Vec<u32> = mt.roots().map(|(root, _)| root).collect();
        let (mut stack, mut splits) = (Vec::new(), 0);
        while let Some(node) = nodes.pop() {
            let Some(update) = mt.update_of(node) else { continue };
            // Balls nest, so nothing below is concerned either.
            if !limits.concerns(&mt.ball_at(update, node)) {
                continue;
            }
            if self.front.state(node) != VertexState::Split {
                splits += self.front.force(update, &mut stack);
            }
            nodes.extend(mt.children(update));
        }
        splits
    }

    fn begin_requests(&mut self) {
        self.front.triangles.mark();
        self.schedule.forget();
    }
}

impl Front<'_> {
    /// Returns the active vertex that shows a node at or below the cut.
    fn shown_by(&self, mut node: u32) -> u32 {
        while self.state(node) == VertexState::Absent {
            let up = self.mt.creator(node).expect("roots are active or split");
            node = self.mt.parent(up);
        }
        node
    }

    /// Applies an update whose node is active or below the cut, and first all that it depends on.
    fn force(&mut self, update: u32, stack: &mut Vec<u32>) -> usize {
        let mut splits = 0;
        stack.push(update);
        while let Some(&next) = stack.last() {
            let node = self.mt.parent(next);
            match self.state(node) {
                VertexState::Absent => {
                    stack.push(self.mt.creator(node).expect("roots are active or split"));
                }
                VertexState::Split => {
                    stack.pop();
                }
                VertexState::Active => {
                    if self.split(next, stack) {
                        stack.pop();
                        splits += 1;
                        if self.mt.is_fused_with_child(next) {
                            stack.push(next + 1);
                        }
                    }
                }
            }
        }
        splits
    }
}
