//! Steps that are measured before their turn, side by side.
//!
//! Contractions are carried out one after the other, and most of the time of a bounded run goes into
//! measuring them. The vertices of a batch are most often far apart: what is found of the next steps
//! at once still holds in their turn, unless one was carried out around them. So the result is the
//! same, to the bit, with any number of threads.

use glam::Vec3;
use rayon::prelude::*;

use crate::kernel::bound::moved_part::Measured;
use crate::kernel::bound::step::BoundedStep;
use crate::kernel::collapse::edge_ring::EdgeRing;

/// Number of steps measured since the last batch from which on it pays to look ahead.
const WORTH: usize = 4;

/// Steps that are planned, and what was found of them.
#[derive(Default)]
pub(crate) struct LookAhead {
    steps: Vec<PlannedStep>,
    /// Vertices that remained of edges contracted since the steps were planned.
    changed: Vec<u32>,
    /// Number of steps measured since then.
    measured: usize,
}

/// A step with a ring of its own.
struct PlannedStep {
    edge_ring: EdgeRing,
    ends: [u32; 2],
    from: Vec3,
    displacement: Vec3,
    now: f32,
    found: Option<Measured>,
}

impl PlannedStep {
    fn of(&BoundedStep { edge_ring, ends, from, displacement, now }: &BoundedStep<'_>) -> Self {
        Self { edge_ring: edge_ring.clone(), ends, from, displacement, now, found: None }
    }

    fn step(&self) -> BoundedStep<'_> {
        let &Self { ref edge_ring, ends, from, displacement, now, .. } = self;
        BoundedStep { edge_ring, ends, from, displacement, now }
    }
}

impl LookAhead {
    /// Forgets all plans. Returns true if it pays to make new ones.
    pub(crate) fn begin(&mut self) -> bool {
        let pays = self.measured >= WORTH && rayon::current_num_threads() > 1;
        self.steps.clear();
        self.changed.clear();
        self.measured = 0;
        pays
    }

    pub(crate) fn plan(&mut self, step: &BoundedStep<'_>) {
        self.steps.push(PlannedStep::of(step));
    }

    /// Measures all planned steps.
    pub(crate) fn measure(&mut self, measure: impl Fn(&BoundedStep<'_>) -> Measured + Sync) {
        let steps = self.steps.par_iter_mut().with_max_len(1);
        steps.for_each(|planned| planned.found = Some(measure(&planned.step())));
    }

    /// Returns what was found of the planned steps.
    pub(crate) fn found(&self) -> impl Iterator<Item = &Measured> {
        self.steps.iter().filter_map(|planned| planned.found.as_ref())
    }

    /// Returns what was found of a step, if it was planned and still holds. Counts it.
    pub(crate) fn take(&mut self, step: &BoundedStep<'_>) -> Option<Measured> {
        self.measured += 1;
        if self.steps.is_empty() {
            return None;
        }
        let BoundedStep { edge_ring, ends, from, displacement, .. } = step;
        let is_changed = |v: &u32| ends.contains(v) || edge_ring.ids().contains(v);
        if self.changed.iter().any(is_changed) {
            return None;
        }
        let is_same = |planned: &&PlannedStep| {
            planned.ends == *ends && (planned.from, planned.displacement) == (*from, *displacement)
        };
        self.steps.iter().find(is_same)?.found
    }

    /// Notes that an edge was contracted into a vertex.
    pub(crate) fn forget_around(&mut self, kept: u32) {
        if !self.steps.is_empty() {
            self.changed.push(kept);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_planned_step_is_measured_once_unless_something_changes_around_it() {
        let mut edge_ring = EdgeRing::new(1.0);
        (edge_ring.ids[0], edge_ring.len) = (7, 1);
        let step = |v0: u32| BoundedStep {
            edge_ring: &edge_ring,
            ends: [v0, 2],
            from: Vec3::ZERO,
            displacement: Vec3::X,
            now: 0.5,
        };
        let mut ahead = LookAhead::default();
        (0..WORTH).for_each(|_| assert!(ahead.take(&step(1)).is_none()));
        rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap().install(|| {
            assert!(ahead.begin() && !ahead.begin());
            ahead.plan(&step(1));
            ahead.measure(|step| Ok(step.now));
        });
        assert_eq!(ahead.found().count(), 1);
        assert!(matches!(ahead.take(&step(1)), Some(Ok(0.5))));
        assert!(ahead.take(&step(3)).is_none(), "not planned");
        ahead.forget_around(4);
        assert!(ahead.take(&step(1)).is_some(), "far away");
        ahead.forget_around(7);
        assert!(ahead.take(&step(1)).is_none(), "of its ring");
    }
}
