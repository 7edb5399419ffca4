//! Splits and merges of the shown cut, and where its vertices go.

use super::{Geomorph, SplitOrMerge, VertexState, VertexValues};
use crate::cut::refine::outer;
use crate::implicit::Implicit;

impl Geomorph<'_> {
    /// Starts a new record of what changes.
    pub(super) fn begin(&mut self) {
        self.shown.triangles.mark();
        self.turned.clear();
        self.arrived.clear();
        self.has_time_passed = false;
    }

    /// Splits what the goal has split. What it has merged waits until vertices have arrived.
    pub(super) fn follow(&mut self, step: SplitOrMerge) {
        // One that has not been undone yet stays.
        if let SplitOrMerge::Split(update) = step
            && self.shown.state(self.shown.mt.parent(update)) != VertexState::Split
        {
            self.split(update);
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
        self.forget(node);
        for child in mt.children(update) {
            below.set_to_child(mt, &above, update, child);
            // Where it goes is still to be seen.
            self.motions.rest(child, &below);
        }
        self.spare.extend([above, below]);
    }

    /// Lists the goal's vertices that steps brought, some of them more than once.
    pub(super) fn list_new_goals(&mut self, steps: &[SplitOrMerge]) {
        let (mt, goal) = (self.shown.mt, &self.goal.front);
        let nodes = steps.iter().flat_map(|&step| {
            let (merged, split) = match step {
                SplitOrMerge::Merge(update) => (Some(mt.parent(update)), None),
                SplitOrMerge::Split(update) => (None, Some(mt.children(update))),
            };
            merged.into_iter().chain(split.into_iter().flatten())
        });
        self.new_goals.clear();
        self.new_goals.extend(nodes.filter(|&node| goal.is_active(node)));
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

    /// Sends a vertex from where it is to somewhere, unless it is on the way there.
    fn send(&mut self, node: u32, to: &VertexValues) {
        if self.motions.is_under_way(node) && self.motions.leads_to(node, to) {
            return;
        }
        let mut from = self.spare();
        self.values(node, &mut from);
        self.motions.send(node, [&from, to]);
        self.turned.push(node);
        self.spare.push(from);
        if !self.motions.is_under_way(node) {
            self.arrive(node);
        }
    }

    /// Ends the motion of a vertex that has arrived where the goal has it; elsewhere it may be time to
    /// undo the update that brought it.
    pub(super) fn arrive(&mut self, node: u32) {
        match self.goal.front.is_active(node) {
            true => _ = self.motions.remove(node),
            false => self.ending.extend(self.shown.mt.creator(node)),
        }
    }

    /// Forgets a vertex that leaves the cut.
    fn forget(&mut self, node: u32) {
        self.motions.remove(node);
        self.turned.push(node);
    }

    /// Undoes the updates whose children have all arrived at the node that replaces them: those that
    /// were noted, and then those that become free.
    pub(super) fn end_merges(&mut self) {
        let mt = self.shown.mt;
        while let Some(update) = self.ending.pop() {
            // Fused updates are undone with the outer one; the goal has both or none.
            if self.goal.front.state(mt.parent(update)) == VertexState::Split {
                continue;
            }
            let update = outer(mt, update);
            if !self.ends(update) {
                continue;
            }
            let inner = mt.is_fused_with_child(update).then_some(update + 1);
            inner.into_iter().chain([update]).for_each(|part| self.join(mt, part));
            let around = self.shown.around(mt.parent(update)).iter();
            self.ending.extend(around.filter_map(|&node| mt.creator(node)));
        }
    }

    /// Undoes an update and returns true, if its time has come.
    fn ends(&mut self, update: u32) -> bool {
        let (mt, is_split) = (self.shown.mt, |state| state == VertexState::Split);
        let node = mt.parent(update);
        if is_split(self.goal.front.state(node)) || !is_split(self.shown.state(node)) {
            return false;
        }
        let inner = mt.is_fused_with_child(update).then(|| mt.children(update + 1));
        let mut children = mt.children(update).into_iter().chain(inner.into_iter().flatten());
        !children.any(|child| self.motions.is_under_way(child)) && self.shown.merge(update)
    }

    /// Makes the node of an update look like the children that it has replaced.
    fn join(&mut self, mt: &Implicit, update: u32) {
        let (node, children) = (mt.parent(update), mt.children(update));
        self.turned.push(node);
        if self.goal.front.is_active(node) {
            // They have arrived where it is at home.
            return children.into_iter().for_each(|child| self.forget(child));
        }
        let mut shown = [self.spare(), self.spare()];
        for (child, shown) in children.into_iter().zip(&mut shown) {
            self.values(child, shown);
            self.forget(child);
        }
        let mut joined = self.spare();
        let [first, second] = &shown;
        joined.set_to_parent(mt, update, [(children[0], first), (children[1], second)]);
        self.motions.rest(node, &joined);
        self.arrive(node);
        self.spare.extend(shown);
        self.spare.push(joined);
    }

    /// Returns room for the state of a vertex, with any content.
    fn spare(&mut self) -> VertexValues {
        self.spare.pop().unwrap_or_default()
    }
}
