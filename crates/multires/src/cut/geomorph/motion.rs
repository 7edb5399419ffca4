//! Vertices under way, and the splits and merges of the shown cut.

use std::time::Duration;

use super::{Geomorph, SplitOrMerge, VertexState, VertexValues};
use crate::implicit::Implicit;

/// Motion of a vertex, from what it was when it set out to what it will be.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    from: VertexValues,
    to: VertexValues,
    elapsed: Duration,
}

impl Motion {
    /// Returns the motion of a vertex that stays as it is.
    fn at_rest(values: VertexValues) -> Self {
        Self { from: values.clone(), to: values, elapsed: Duration::MAX }
    }

    pub(super) fn advance(&mut self, elapsed: Duration) {
        self.elapsed = self.elapsed.saturating_add(elapsed);
    }

    /// Returns true if the vertex has arrived.
    pub(super) fn is_over(&self, duration: Duration) -> bool {
        self.elapsed >= duration
    }

    /// Returns what the vertex is now.
    pub(super) fn values(&self, mt: &Implicit, duration: Duration) -> VertexValues {
        let weight = match self.is_over(duration) {
            true => 1.0,
            false => self.elapsed.as_secs_f64() / duration.as_secs_f64(),
        };
        VertexValues::between(mt, [&self.from, &self.to], weight)
    }
}

impl Geomorph<'_> {
    /// Starts a new record of what changes.
    pub(super) fn begin(&mut self) {
        self.shown.triangles.mark();
        self.arrived.clear();
    }

    /// Does what the goal did: a split at once, a merge when its time has come.
    pub(super) fn follow(&mut self, step: SplitOrMerge) {
        let mt = self.shown.mt;
        match step {
            SplitOrMerge::Merge(update) => {
                self.ending.insert((mt.level(update), update));
            }
            SplitOrMerge::Split(update) => {
                // One that has not been undone yet stays.
                if !self.ending.remove(&(mt.level(update), update)) {
                    self.split(update);
                }
            }
        }
    }

    /// Splits a vertex of the shown cut into two that look like it.
    fn split(&mut self, update: u32) {
        let mt = self.shown.mt;
        let node = mt.parent(update);
        let values = self.values(node);
        // The shown cut contains the goal, and in a certified model that is all that a split needs.
        let is_split = self.shown.is_active(node) && self.shown.split(update, &mut Vec::new());
        debug_assert!(is_split, "the shown cut contains the goal");
        if is_split {
            self.moving.remove(&node);
            for child in mt.children(update) {
                let motion = Motion::at_rest(values.of_child(mt, update, child));
                self.moving.insert(child, motion);
            }
        }
    }

    /// Returns the goal's vertices that steps brought, in rising order.
    pub(super) fn new_goals(&self, steps: &[SplitOrMerge]) -> Vec<u32> {
        let (mt, goal) = (self.shown.mt, &self.goal.front);
        let nodes = steps.iter().flat_map(|&step| match step {
            SplitOrMerge::Merge(update) => [mt.parent(update); 2],
            SplitOrMerge::Split(update) => mt.children(update),
        });
        let mut nodes: Vec<u32> = nodes.filter(|&node| goal.is_active(node)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Sends all that the shown cut has below a vertex of the goal to that vertex.
    pub(super) fn send_below(&mut self, goal: u32) {
        let mt = self.shown.mt;
        let mut stack = vec![(goal, VertexValues::of(mt, goal))];
        while let Some((node, to)) = stack.pop() {
            match (self.shown.state(node), mt.update_of(node)) {
                (VertexState::Active, _) => self.send(node, to),
                (VertexState::Split, Some(update)) => {
                    let children = mt.children(update).into_iter();
                    stack.extend(children.map(|child| (child, to.of_child(mt, update, child))));
                }
                _ => {}
            }
        }
    }

    /// Sends a vertex from where it is to somewhere, unless it is on the way there or at home.
    fn send(&mut self, node: u32, to: VertexValues) {
        if self.moving.get(&node).is_some_and(|motion| motion.to == to) {
            return self.drop_if_home(node);
        }
        let from = self.values(node);
        let elapsed = if from == to { Duration::MAX } else { Duration::ZERO };
        self.moving.insert(node, Motion { from, to, elapsed });
        self.drop_if_home(node);
    }

    /// Ends the motion of a vertex that has arrived where the goal has it.
    fn drop_if_home(&mut self, node: u32) {
        let is_over = |motion: &Motion| motion.is_over(self.duration);
        if self.moving.get(&node).is_some_and(is_over) && self.goal.front.is_active(node) {
            self.moving.remove(&node);
            self.arrived.push(node);
        }
    }

    /// Undoes the updates whose children have all arrived at the node that replaces them.
    pub(super) fn end_merges(&mut self) {
        let mt = self.shown.mt;
        let waiting: Vec<(u16, u32)> = self.ending.iter().copied().collect();
        // Dependents have lower levels and come first.
        for (level, update) in waiting {
            if mt.is_fused_with_parent(update) {
                continue;
            }
            let parts = [Some(update), mt.is_fused_with_child(update).then(|| update + 1)];
            let mut children = parts.into_iter().flatten().flat_map(|part| mt.children(part));
            let is_moving = |node: &u32| {
                self.moving.get(node).is_some_and(|motion| !motion.is_over(self.duration))
            };
            if children.any(|child| is_moving(&child)) || !self.shown.merge(update) {
                continue;
            }
            for part in parts.into_iter().flatten().rev() {
                self.ending.remove(&(if part == update { level } else { mt.level(part) }, part));
                self.join(part);
            }
        }
    }

    /// Makes the node of an update look like the children that it has replaced.
    fn join(&mut self, update: u32) {
        let mt = self.shown.mt;
        let node = mt.parent(update);
        let children = mt.children(update).map(|child| (child, self.values(child)));
        children.iter().for_each(|(child, _)| drop(self.moving.remove(child)));
        let values = VertexValues::of_parent(mt, update, children);
        self.moving.insert(node, Motion::at_rest(values));
        self.drop_if_home(node);
    }
}
