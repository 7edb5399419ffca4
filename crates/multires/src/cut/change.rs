//! How the cut changes: what is wanted is split, and what is neither wanted nor needed is merged.

use super::front::Standing;
use super::{Cut, Needed, Work};
use crate::implicit::Implicit;

impl Cut<'_> {
    /// Splits what is wanted, and what must be split for it.
    pub(super) fn refine(&mut self, needs: &Needed<'_>, work: &mut Work) {
        let mut stack = Vec::new();
        while let Some(update) = self.fresh.pop() {
            // It may have been forced, or merged with all around it.
            if self.front.standing(self.front.mt.parent(update)) != Standing::Active {
                continue;
            }
            stack.push(update);
            while let Some(&next) = stack.last() {
                if !work.may_go_on() {
                    self.fresh.push(update);
                    return;
                }
                self.advance(next, needs, &mut stack, work);
            }
        }
    }

    /// Splits the last update of a chain, or finds what must come before it.
    fn advance(&mut self, next: u32, needs: &Needed<'_>, stack: &mut Vec<u32>, work: &mut Work) {
        let mt = self.front.mt;
        let node = mt.parent(next);
        match self.front.standing(node) {
            Standing::Absent => {
                stack.push(mt.family(node).expect("roots are there until they are split"));
                return;
            }
            Standing::Split => {
                stack.pop();
                return;
            }
            Standing::Active => {}
        }
        if !self.front.split(next, stack) {
            return;
        }
        stack.pop();
        work.change.splits += 1;
        let is_forced = !stack.is_empty();
        if is_forced && !needs.may_stay(&mt.ball_at(next, node)) {
            // It may go as soon as nothing holds it.
            self.loose.push(next);
        }
        // What is around the whole is around its part, if the model has a certificate.
        if mt.is_glued(next) && self.front.split(next + 1, stack) {
            self.arrive(next + 1, needs);
        }
        self.arrive(next, needs);
    }

    /// Merges what is not wanted and not needed, and what that frees.
    pub(super) fn coarsen(&mut self, needs: &Needed<'_>, work: &mut Work) {
        while work.may_go_on() {
            let Some(update) = self.loose.pop() else { return };
            let mt = self.front.mt;
            let node = mt.parent(update);
            if self.front.standing(node) != Standing::Split
                || needs.may_stay(&mt.ball_at(update, node))
                || !self.front.merge(update)
            {
                continue;
            }
            work.change.merges += 1;
            let Self { front, loose, .. } = self;
            loose.extend(mt.family(node).map(|up| outer(mt, up)));
            let around = front.around(node).iter().filter_map(|&other| mt.family(other));
            loose.extend(around.map(|up| outer(mt, up)));
        }
    }
}

/// The update that is glued to this one and goes first, or itself.
fn outer(mt: &Implicit, update: u32) -> u32 {
    if mt.is_inner(update) { update - 1 } else { update }
}
