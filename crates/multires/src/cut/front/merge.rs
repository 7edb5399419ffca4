//! Guarded merges: the children of an update become its node again, where no other depends on it.

use super::{ABSENT, Front, SplitOrMerge, Vertex, VertexState};
use crate::cut::split_wedges::SplitWedges;
use crate::cut::triangles::{MAX_SEARCHED, NEXT, Spoke};

impl Front<'_> {
    /// Undoes a split and returns true, if no other update depends on it: its neighbourhood is the
    /// recorded one.
    ///
    /// Fused updates are undone together.
    pub(in crate::cut) fn merge(&mut self, update: u32) -> bool {
        let fused_with_child = self.mt.is_fused_with_child(update);
        let [first, second] = self.mt.children(update);
        let inner = if fused_with_child { self.mt.children(update + 1) } else { [first; 2] };
        let parts = [second, inner[0], inner[1]];
        if parts.iter().any(|&child| self.state(child) != VertexState::Active) {
            return false;
        }
        let level = self.mt.level(update);
        let is_needed = |n: u32| !parts.contains(&n) && !self.is_made_above(n, level);
        // A vertex that cannot be merged mostly shows it at one of its first triangles.
        let is_held = |&child: &u32| {
            let mut around = self.triangles.around(self.vertices[child as usize].corner);
            around.any(|spoke| is_needed(spoke.a) || is_needed(spoke.b))
        };
        if parts[..if fused_with_child { 3 } else { 2 }].iter().any(is_held) {
            return false;
        }
        if fused_with_child {
            self.undo(update + 1);
        }
        self.undo(update);
        true
    }

    /// Replaces both children of an update by its node.
    fn undo(&mut self, update: u32) {
        self.record(SplitOrMerge::Merge(update));
        let node = self.mt.parent(update);
        let [first, second] = self.mt.children(update);
        let above = self.mt.creator(node).map_or(u16::MAX, |up| self.mt.level(up));
        let wedges = self.mt.wedges().map(|all| SplitWedges::new(all, self.mt, update));
        self.star.clear();
        for child in [first, second] {
            let start = self.star.len();
            self.triangles.gather(self.vertices[child as usize].corner, &mut self.star);
            self.vertices[child as usize].corner = ABSENT;
            if let Some(wedges) = &wedges {
                for spoke in &self.star[start..] {
                    let merged = wedges.merged(child, self.triangles.wedge(spoke.corner));
                    self.triangles.set_wedge(spoke.corner, merged);
                }
            }
        }
        self.active -= 2;
        self.activate(node, above);
        for i in 0..self.star.len() {
            let Spoke { corner, a, b } = self.star[i];
            let mut others = [a, b].into_iter().filter(|&n| n != first && n != second);
            match (others.next(), others.next()) {
                (Some(_), Some(_)) => {
                    let Vertex { corner: list, .. } = &mut self.vertices[node as usize];
                    self.triangles.attach(corner, node, list);
                }
                // It is met from both ends; the first removes it.
                (Some(wing), None) if self.is_first(i) => {
                    self.remove(corner / 3, wing, [first, second, node]);
                }
                _ => {}
            }
        }
    }

    /// Removes a triangle that is left in the list of one vertex only. `joined` are vertices whose
    /// lists are invalid at this point.
    fn remove(&mut self, t: u32, wing: u32, invalid: [u32; 3]) {
        let Self { triangles, vertices, .. } = self;
        let list = &mut vertices[wing as usize].corner;
        if triangles.unlink(t, list, MAX_SEARCHED) {
            triangles.remove(t);
            return;
        }
        // At a hub, searching the whole list for each removal would take quadratic time. Instead a
        // triangle from the start of the list takes the removed one's slot, as its other two lists
        // are short.
        let Some(other) = triangles.unlink_without(list, invalid) else {
            triangles.unlink(t, list, usize::MAX);
            triangles.remove(t);
            return;
        };
        let at = triangles.nodes(t).iter().position(|&node| node == wing);
        let (mut to, mut from) = (at.expect("a wing is a corner"), other as usize % 3);
        triangles.set_wedge(3 * t + to as u32, triangles.wedge(other));
        for _ in 0..2 {
            (to, from) = (NEXT[to], NEXT[from]);
            let node = triangles.nodes(other / 3)[from];
            let [corner, by] = [other / 3 * 3 + from as u32, 3 * t + to as u32];
            triangles.replace(corner, by, node, &mut vertices[node as usize].corner);
        }
        triangles.remove(other / 3);
    }

    /// Returns true if no earlier entry of the star has the same triangle.
    fn is_first(&self, place: usize) -> bool {
        let t = self.star[place].corner / 3;
        self.star[..place].iter().all(|spoke| spoke.corner / 3 != t)
    }
}
