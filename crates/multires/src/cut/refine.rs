//! Refinement and coarsening: required updates are applied, and those neither required nor depended
//! on are undone.

use super::front::VertexState;
use super::{Criteria, Cut, Meter};
use crate::implicit::Implicit;

impl Cut<'_> {
    /// Applies the queued updates with their dependencies.
    pub(super) fn refine(&mut self, criteria: &Criteria<'_>, meter: &mut Meter) {
        let mut stack = Vec::new();
        while let Some(update) = self.to_split.pop() {
            // It may have been forced already, or merged with its surroundings.
            if self.front.state(self.front.mt.parent(update)) != VertexState::Active {
                continue;
            }
            stack.push(update);
            while let Some(&next) = stack.last() {
                if !meter.may_change_more() {
                    self.to_split.push(update);
                    return;
                }
                self.advance(next, criteria, &mut stack, meter);
            }
        }
    }

    /// Applies the last update of a chain, or pushes the updates that have to come first.
    fn advance(
        &mut self,
        next: u32,
        criteria: &Criteria<'_>,
        stack: &mut Vec<u32>,
        meter: &mut Meter,
    ) {
        let mt = self.front.mt;
        let node = mt.parent(next);
        match self.front.state(node) {
            VertexState::Absent => {
                stack.push(mt.creator(node).expect("roots are there until they are split"));
                return;
            }
            VertexState::Split => {
                stack.pop();
                return;
            }
            VertexState::Active => {}
        }
        if !self.front.split(next, stack) {
            return;
        }
        stack.pop();
        meter.change.splits += 1;
        let is_forced = !stack.is_empty();
        if is_forced && !criteria.may_stay(&mt.ball_at(next, node)) {
            // It may go as soon as no update depends on it.
            self.to_merge.push(next);
        }
        // In a certified model the neighbours of the whole are also those of its part.
        if mt.is_fused_with_child(next) && self.front.split(next + 1, stack) {
            self.inspect_children(next + 1, criteria);
        }
        self.inspect_children(next, criteria);
    }

    /// Undoes updates that are neither required nor depended on, and then those that become free.
    pub(super) fn coarsen(&mut self, criteria: &Criteria<'_>, meter: &mut Meter) {
        while meter.may_change_more() {
            let Some(update) = self.to_merge.pop() else { return };
            let mt = self.front.mt;
            let node = mt.parent(update);
            if self.front.state(node) != VertexState::Split
                || criteria.may_stay(&mt.ball_at(update, node))
                || !self.front.merge(update)
            {
                continue;
            }
            meter.change.merges += 1;
            let Self { front, to_merge, .. } = self;
            to_merge.extend(mt.creator(node).map(|up| outer(mt, up)));
            let around = front.around(node).iter().filter_map(|&other| mt.creator(other));
            to_merge.extend(around.map(|up| outer(mt, up)));
        }
    }
}

/// Returns the first of two fused updates, or the update itself.
pub(super) fn outer(mt: &Implicit, update: u32) -> u32 {
    if mt.is_fused_with_parent(update) { update - 1 } else { update }
}
