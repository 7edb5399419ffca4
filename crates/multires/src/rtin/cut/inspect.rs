//! Inspection of vertices against a query: those that are due by the schedule, or all whose nested
//! balls are required.

use super::RtinCut;
use super::front::FieldFront;
use crate::cut::{Meter, ScheduleEntry, Span};
use crate::query::{Ball, Criterion};
use crate::rtin::grid::GridPoint;

/// State of a vertex's inspection since everything was last inspected.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Inspected {
    /// It is on the schedule.
    is_scheduled: bool,
    /// Its nested ball was required when it was last inspected, or it is in every level: its
    /// dependents have been inspected, and are again when they are due.
    is_open: bool,
}

impl FieldFront<'_> {
    /// Returns true if a vertex is required by itself.
    pub(super) fn requires(&self, criterion: &Criterion<'_>, index: u32) -> bool {
        criterion.requires(&self.model.own_ball(self.model.grid.place(index as usize)))
    }
}

impl RtinCut<'_> {
    /// Starts to inspect every vertex of the cut, and those that the query may require.
    ///
    /// Cost: linear in the field, two bytes of each vertex, and in the entries on the schedule.
    pub(super) fn restart(&mut self) {
        self.schedule.clear(|_| {});
        self.inspected.fill(Inspected::default());
        self.to_insert.clear();
        self.to_remove.clear();
        self.uninspected.clear();
        self.uninspected.extend(&self.front.first);
    }

    /// Inspects the vertices that are due, then continues with those not yet seen, coarse before
    /// fine.
    pub(super) fn inspect_pending(&mut self, criterion: &Criterion<'_>, meter: &mut Meter) {
        while let Some(entry) = self.schedule.due.pop() {
            self.inspect_due(entry, criterion);
            if !meter.may_inspect_more() {
                return;
            }
        }
        while let Some(index) = self.uninspected.pop_front() {
            // It may depend on two vertices.
            let Inspected { is_scheduled, is_open } = self.inspected[index as usize];
            if is_scheduled || is_open {
                continue;
            }
            self.inspect(index, criterion);
            if !meter.may_inspect_more() {
                return;
            }
        }
    }

    /// Inspects a vertex that is due, or puts it back if its decision cannot have changed. Forgets
    /// one that is not in the cut and depends on no open vertex: opening one of these inspects it.
    fn inspect_due(&mut self, entry: ScheduleEntry, criterion: &Criterion<'_>) {
        if self.schedule.add_again(entry) {
            return;
        }
        let index = entry.node as usize;
        self.inspected[index].is_scheduled = false;
        let grid = &self.front.model.grid;
        let mut parents = grid.parents(grid.place(index)).map(|at| grid.index(at));
        if self.front.has(index) || parents.any(|parent| self.inspected[parent].is_open) {
            self.inspect(entry.node, criterion);
        } else {
            self.inspected[index].is_open = false;
        }
    }

    /// Queues a vertex for insertion or removal as the criterion demands, schedules its next
    /// inspection, and queues what depends on it to be inspected if that may be required.
    fn inspect(&mut self, index: u32, criterion: &Criterion<'_>) {
        let model = self.front.model;
        let place = model.grid.place(index as usize);
        if model.vertices[index as usize].is_forced() {
            self.inspected[index as usize].is_open = true;
            return self.queue_dependents(place);
        }
        let (own, nested) = (model.own_ball(place), model.nested_ball(place));
        let required = [&own, &nested].map(|ball| criterion.requires(ball));
        let is_in = self.front.has(index as usize);
        match (is_in, required[0]) {
            (true, false) => self.to_remove.push(index),
            (false, true) => self.to_insert.push(index),
            _ => {}
        }
        let entry = ScheduleEntry {
            update: index,
            node: index,
            center: own.center.as_vec3().into(),
            span: span(criterion, [&own, &nested], required),
        };
        let is_scheduled = self.schedule.add(entry);
        let now = Inspected { is_scheduled, is_open: required[1] };
        let was_open = std::mem::replace(&mut self.inspected[index as usize], now).is_open;
        // What depends on a vertex of the cut may be in it, too.
        if !was_open && (now.is_open || is_in) {
            self.queue_dependents(place);
        }
    }

    fn queue_dependents(&mut self, place: GridPoint) {
        let grid = self.front.model.grid;
        self.uninspected.extend(grid.dependents(place).map(|at| grid.index(at) as u32));
    }
}

/// Returns the distances of the viewpoint between which neither decision changes. The balls have
/// one centre, and the second is the larger.
fn span(criterion: &Criterion<'_>, balls: [&Ball; 2], required: [bool; 2]) -> Span {
    let viewpoint = criterion.viewpoint();
    let [own, nested] = balls.map(|ball| viewpoint.and_then(|viewpoint| viewpoint.reach(ball)));
    let (Some(own), Some(nested)) = (own, nested) else { return Span::NEVER_TURNS };
    // The schedule has the centre in single precision.
    let center = balls[0].center;
    let off = center.distance(center.as_vec3().as_dvec3());
    match required {
        [true, _] => Span::below(own - off),
        [false, true] => Span::above(own + off).and_below(nested - off),
        [false, false] => Span::above(nested + off),
    }
}
