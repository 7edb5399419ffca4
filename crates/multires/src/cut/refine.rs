//! How the cut changes: what is wanted is split, and what is neither wanted nor needed is merged.

use super::front::VertexState;
use super::{Criteria, Cut, Meter};
use crate::implicit::Implicit;

impl Cut<'_> {
    /// Splits what is wanted, and what must be split for it.
    pub(super) fn refine(&mut self, criteria: &Criteria<'_>, meter: &mut Meter) {
        let mut stack = Vec::new();
        while let Some(update) = self.to_split.pop() {
            // It may have been forced, or merged with all around it.
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

    /// Splits the last update of a chain, or finds what must come before it.
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
            // It may go as soon as nothing holds it.
            self.to_merge.push(next);
        }
        // What is around the whole is around its part, if the model has a certificate.
        if mt.is_fused_with_child(next) && self.front.split(next + 1, stack) {
            self.inspect_children(next + 1, criteria);
        }
        self.inspect_children(next, criteria);
    }

    /// Merges what is not wanted and not needed, and what that frees.
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

/// The update that is glued to this one and goes first, or itself.
fn outer(mt: &Implicit, update: u32) -> u32 {
    if mt.is_fused_with_parent(update) { update - 1 } else { update }
}
