//! Inspection of updates against a query: those that are due by the schedule, or all.

use super::front::VertexState;
use super::schedule::ScheduleEntry;
use super::{Criteria, Cut, Meter};

impl Cut<'_> {
    /// Starts to inspect every update whose vertex is active or has been split.
    ///
    /// Cost: linear in the entries on the schedule.
    pub(super) fn restart(&mut self) {
        // This includes vertices that do not exist now, as they may return.
        self.schedule.clear(|node| self.front.set_scheduled(node, false));
        self.to_split.clear();
        self.to_merge.clear();
        self.uninspected.clear();
        self.uninspected.extend(self.front.mt.roots().map(|(root, _)| root));
    }

    /// Inspects the updates that are due, then continues with those not yet seen, coarse before
    /// fine.
    pub(super) fn inspect_pending(&mut self, criteria: &Criteria<'_>, meter: &mut Meter) {
        while let Some(entry) = self.schedule.due.pop() {
            self.inspect_due(entry, criteria);
            if !meter.may_inspect_more() {
                return;
            }
        }
        let mt = self.front.mt;
        while let Some(node) = self.uninspected.pop_front() {
            let Some(update) = mt.update_of(node) else { continue };
            if self.front.state(node) == VertexState::Split {
                self.uninspected.extend(mt.children(update));
            }
            // It may have been split and inspected since it was queued.
            if mt.is_fused_with_parent(update) || self.front.is_scheduled(node) {
                continue;
            }
            self.inspect(update, node, criteria);
            if !meter.may_inspect_more() {
                return;
            }
        }
    }

    /// Inspects an update that is due, or puts it back if its decision cannot have changed.
    #[inline]
    fn inspect_due(&mut self, entry: ScheduleEntry, criteria: &Criteria<'_>) {
        if !self.schedule.add_again(entry) {
            self.front.set_scheduled(entry.node, false);
            self.inspect(entry.update, entry.node, criteria);
        }
    }

    /// Queues an update for a split or a merge as the criteria demand, and schedules its next
    /// inspection.
    fn inspect(&mut self, update: u32, node: u32, criteria: &Criteria<'_>) {
        let ball = self.front.mt.ball_at(update, node);
        let required = criteria.required(&ball);
        match (self.front.state(node), required) {
            (VertexState::Split, [_, false]) => self.to_merge.push(update),
            (VertexState::Active, [true, _]) => self.to_split.push(update),
            (VertexState::Split | VertexState::Active, _) => {}
            (VertexState::Absent, _) => return,
        }
        let center = self.front.mt.stored_position(node);
        let entry = ScheduleEntry { update, node, center, span: criteria.span(&ball, required) };
        if self.schedule.add(entry) {
            self.front.set_scheduled(node, true);
        }
    }

    /// Inspects the children of a split for the first time.
    pub(super) fn inspect_children(&mut self, update: u32, criteria: &Criteria<'_>) {
        let mt = self.front.mt;
        let first_is_gone = usize::from(mt.is_fused_with_child(update));
        for node in mt.children(update).into_iter().skip(first_is_gone) {
            let Some(update) = mt.update_of(node) else { continue };
            if !self.front.is_scheduled(node) {
                self.inspect(update, node, criteria);
            } else if criteria.refine.requires(&mt.ball_at(update, node)) {
                self.to_split.push(update);
            }
        }
    }
}
