//! Splits and merges of the shown cut, and where its vertices go.

use std::time::Duration;

use super::{Geomorph, SplitOrMerge, VertexState, VertexValues};
use crate::implicit::Implicit;

impl Geomorph<'_> {
    /// Starts a new record of what changes.
    pub(super) fn begin(&mut self) {
        self.shown.triangles.mark();
        self.moved.clear();
    }

    /// Does what the goal did: a split at once, a merge when its time has come.
    pub(super) fn follow(&mut self, step: SplitOrMerge) {
        let mt = self.shown.mt;
        match step {
            SplitOrMerge::Merge(update) => {
                self.ending.push((mt.level(update), update));
                self.is_ending_sorted = false;
            }
            // One that has not been undone yet stays.
            SplitOrMerge::Split(update) => {
                if self.shown.state(mt.parent(update)) != VertexState::Split {
                    self.split(update);
                }
            }
        }
    }

    /// Splits a vertex of the shown cut into two that look like it.
    fn split(&mut self, update: u32) {
        let mt = self.shown.mt;
        let node = mt.parent(update);
        // The shown cut contains the goal, and in a certified model that is all that a split needs.
        self.first.clear();
        let is_split = self.shown.is_active(node) && self.shown.split(update, &mut self.first);
        debug_assert!(is_split, "the shown cut contains the goal");
        if !is_split {
            return;
        }
        let (mut above, mut below) = (self.spare(), self.spare());
        self.values(node, &mut above);
        self.motions.remove(node);
        for child in mt.children(update) {
            below.set_to_child(mt, &above, update, child);
            self.motions.send(child, [&below, &below], Duration::MAX);
            self.moved.push(child);
        }
        self.spare.extend([above, below]);
    }

    /// Lists the goal's vertices that steps brought, in rising order.
    pub(super) fn list_new_goals(&mut self, steps: &[SplitOrMerge]) {
        let (mt, goal) = (self.shown.mt, &self.goal.front);
        let nodes = steps.iter().flat_map(|&step| match step {
            SplitOrMerge::Merge(update) => [mt.parent(update); 2],
            SplitOrMerge::Split(update) => mt.children(update),
        });
        self.new_goals.clear();
        self.new_goals.extend(nodes.filter(|&node| goal.is_active(node)));
        self.new_goals.sort_unstable();
        self.new_goals.dedup();
    }

    /// Sends all that the shown cut has below a vertex of the goal to that vertex.
    pub(super) fn send_below(&mut self, goal: u32) {
        let mt = self.shown.mt;
        let mut to = self.spare();
        to.set_to(mt, goal);
        let mut stack = std::mem::take(&mut self.stack);
        stack.push((goal, to));
        while let Some((node, to)) = stack.pop() {
            match (self.shown.state(node), mt.update_of(node)) {
                (VertexState::Active, _) => self.send(node, &to),
                (VertexState::Split, Some(update)) => {
                    for child in mt.children(update) {
                        let mut of_child = self.spare();
                        of_child.set_to_child(mt, &to, update, child);
                        stack.push((child, of_child));
                    }
                }
                _ => {}
            }
            self.spare.push(to);
        }
        self.stack = stack;
    }

    /// Sends a vertex from where it is to somewhere, unless it is on the way there or at home.
    fn send(&mut self, node: u32, to: &VertexValues) {
        if !self.motions.leads_to(node, to) {
            let mut from = self.spare();
            self.values(node, &mut from);
            let elapsed = if from == *to { Duration::MAX } else { Duration::ZERO };
            self.motions.send(node, [&from, to], elapsed);
            self.spare.push(from);
            // It is there at once if vertices take no time.
            if self.motions.is_over(node, self.duration) {
                self.moved.push(node);
            }
        }
        self.drop_if_home(node);
    }

    /// Ends the motion of a vertex that has arrived where the goal has it.
    fn drop_if_home(&mut self, node: u32) {
        if self.motions.is_over(node, self.duration) && self.goal.front.is_active(node) {
            self.motions.remove(node);
            self.moved.push(node);
        }
    }

    /// Undoes the updates whose children have all arrived at the node that replaces them.
    pub(super) fn end_merges(&mut self) {
        if !std::mem::replace(&mut self.is_ending_sorted, true) {
            self.ending.sort_unstable();
            self.ending.dedup();
        }
        // Dependents have lower levels and come first.
        let mut ending = std::mem::take(&mut self.ending);
        ending.retain(|&(_, update)| !self.ends(update));
        self.ending = ending;
    }

    /// Undoes an update if its time has come. Returns true if it is not to be undone any more.
    fn ends(&mut self, update: u32) -> bool {
        let mt = self.shown.mt;
        if mt.children(update).iter().any(|&child| self.is_under_way(child)) {
            return false;
        }
        let node = mt.parent(update);
        let is_split = |state: VertexState| state == VertexState::Split;
        if !is_split(self.shown.state(node)) || is_split(self.goal.front.state(node)) {
            return true;
        }
        // Fused updates are undone with the outer one.
        let inner = mt.is_fused_with_child(update).then(|| update + 1);
        let mut inner_children = inner.into_iter().flat_map(|part| mt.children(part));
        if mt.is_fused_with_parent(update)
            || inner_children.any(|child| self.is_under_way(child))
            || !self.shown.merge(update)
        {
            return false;
        }
        inner.into_iter().chain([update]).for_each(|part| self.join(mt, part));
        true
    }

    fn is_under_way(&self, node: u32) -> bool {
        self.motions.is_under_way(node, self.duration)
    }

    /// Makes the node of an update look like the children that it has replaced.
    fn join(&mut self, mt: &Implicit, update: u32) {
        let (node, children) = (mt.parent(update), mt.children(update));
        let mut shown = [self.spare(), self.spare()];
        for (child, shown) in children.into_iter().zip(&mut shown) {
            self.values(child, shown);
            self.motions.remove(child);
        }
        let mut joined = self.spare();
        let [first, second] = &shown;
        joined.set_to_parent(mt, update, [(children[0], first), (children[1], second)]);
        self.motions.send(node, [&joined, &joined], Duration::MAX);
        self.moved.push(node);
        self.drop_if_home(node);
        self.spare.extend(shown);
        self.spare.push(joined);
    }

    /// Returns room for the state of a vertex, with any content.
    fn spare(&mut self) -> VertexValues {
        self.spare.pop().unwrap_or_default()
    }
}
