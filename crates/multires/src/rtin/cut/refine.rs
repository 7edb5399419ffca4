//! Refinement and coarsening: required vertices are inserted with what they depend on, and those
//! neither required nor depended on are removed.

use super::RtinCut;
use crate::cut::Meter;
use crate::query::Criterion;

impl RtinCut<'_> {
    /// Inserts the queued vertices with their dependencies.
    pub(super) fn refine(&mut self, criterion: &Criterion<'_>, meter: &mut Meter) {
        let mut stack = Vec::new();
        while let Some(index) = self.to_insert.pop() {
            stack.push(index);
            while let Some(&next) = stack.last() {
                if !meter.may_change_more() {
                    self.to_insert.push(index);
                    return;
                }
                self.advance(next, criterion, &mut stack, meter);
            }
        }
    }

    /// Inserts the last vertex of a chain, or pushes those that it depends on.
    fn advance(
        &mut self,
        next: u32,
        criterion: &Criterion<'_>,
        stack: &mut Vec<u32>,
        meter: &mut Meter,
    ) {
        let grid = &self.front.model.grid;
        let place = grid.place(next as usize);
        let known = stack.len();
        if !self.front.has(next as usize) {
            let parents = grid.parents(place).map(|parent| grid.index(parent));
            stack.extend(parents.filter(|&parent| !self.front.has(parent)).map(|p| p as u32));
            if stack.len() > known {
                return;
            }
            self.front.insert(place);
            meter.change.splits += 1;
            let is_forced = stack.len() > 1;
            if is_forced && !self.front.requires(criterion, next) {
                // It may go as soon as no vertex depends on it.
                self.to_remove.push(next);
            }
        }
        stack.pop();
    }

    /// Removes vertices that are neither required nor depended on, and then those that become free.
    pub(super) fn coarsen(&mut self, criterion: &Criterion<'_>, meter: &mut Meter) {
        while meter.may_change_more() {
            let Some(index) = self.to_remove.pop() else { return };
            let model = self.front.model;
            let (at, place) = (index as usize, model.grid.place(index as usize));
            let mut dependents = model.grid.dependents(place).map(|at| model.grid.index(at));
            if model.vertices[at].is_forced()
                || !self.front.has(at)
                || self.front.requires(criterion, index)
                || dependents.any(|dependent| self.front.has(dependent))
            {
                continue;
            }
            self.front.remove(place);
            meter.change.merges += 1;
            let parents = model.grid.parents(place).map(|parent| model.grid.index(parent) as u32);
            self.to_remove.extend(parents);
        }
    }
}
