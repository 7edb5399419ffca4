//! What the cut looks at: what is due, or everything there is.

use super::front::Standing;
use super::schedule::Entry;
use super::{Cut, Needed, Work};

impl Cut<'_> {
    /// Begins to look at every update whose vertex is there, or was and has been split.
    ///
    /// Cost: of what is on the schedule.
    pub(super) fn start_over(&mut self) {
        // Also what is not there: it may come back.
        self.schedule.clear(|node| self.front.set_scheduled(node, false));
        self.fresh.clear();
        self.loose.clear();
        self.unseen.clear();
        self.unseen.extend(self.front.mt.roots().map(|(root, _)| root));
    }

    /// Looks at what is due and goes on with what is yet to be seen, coarse before fine.
    pub(super) fn look_around(&mut self, needs: &Needed<'_>, work: &mut Work) {
        while let Some(entry) = self.schedule.due.pop() {
            self.look_again(entry, needs);
            if !work.may_look_on() {
                return;
            }
        }
        let mt = self.front.mt;
        while let Some(node) = self.unseen.pop_front() {
            let Some(update) = mt.update_of(node) else { continue };
            if self.front.standing(node) == Standing::Split {
                self.unseen.extend(mt.children(update));
            }
            // It may have been split, and seen, since it was put here.
            if mt.is_inner(update) || self.front.is_scheduled(node) {
                continue;
            }
            self.look(update, node, needs);
            if !work.may_look_on() {
                return;
            }
        }
    }

    /// Looks at what is due.
    #[inline]
    fn look_again(&mut self, entry: Entry, needs: &Needed<'_>) {
        if !self.schedule.add_again(entry) {
            self.front.set_scheduled(entry.node, false);
            self.look(entry.update, entry.node, needs);
        }
    }

    /// Puts an update on the list that its need asks for; and looks again when that may have turned.
    fn look(&mut self, update: u32, node: u32, needs: &Needed<'_>) {
        let ball = self.front.mt.ball_at(update, node);
        let wanted = needs.wanted(&ball);
        match (self.front.standing(node), wanted) {
            (Standing::Split, [_, false]) => self.loose.push(update),
            (Standing::Active, [true, _]) => self.fresh.push(update),
            (Standing::Split | Standing::Active, _) => {}
            (Standing::Absent, _) => return,
        }
        let center = self.front.mt.place(node);
        let entry = Entry { update, node, center, span: needs.span(&ball, wanted) };
        if self.schedule.add(entry) {
            self.front.set_scheduled(node, true);
        }
    }

    /// Looks at the children of a split for the first time.
    pub(super) fn arrive(&mut self, update: u32, needs: &Needed<'_>) {
        let mt = self.front.mt;
        let first_is_gone = usize::from(mt.is_glued(update));
        for node in mt.children(update).into_iter().skip(first_is_gone) {
            let Some(update) = mt.update_of(node) else { continue };
            if !self.front.is_scheduled(node) {
                self.look(update, node, needs);
            } else if needs.least.wants(&mt.ball_at(update, node)) {
                self.fresh.push(update);
            }
        }
    }
}
