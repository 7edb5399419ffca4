//! Work done by an update of a cut, counted against its limits.

use std::time::Instant;

use super::{CutChange, UpdateLimits};

/// Number of inspections, at a few dozen nanoseconds each, between two readings of the clock.
const INSPECTIONS_PER_CLOCK: usize = 256;

/// Counts the work done against the limits.
pub(crate) struct Meter {
    pub(crate) change: CutChange,
    most: usize,
    /// Times at which to stop everything and, before that, to stop inspecting.
    until: Option<[Instant; 2]>,
}

impl Meter {
    pub(crate) fn new(limits: &UpdateLimits) -> Self {
        let now = Instant::now();
        let until = limits.time.map(|time| [time, time / 2].map(|part| now.checked_add(part)));
        Self {
            change: CutChange::default(),
            most: limits.changes.unwrap_or(usize::MAX),
            until: until.and_then(|[all, inspecting]| Some([all?, inspecting?])),
        }
    }

    pub(crate) fn may_change_more(&self) -> bool {
        self.change.splits + self.change.merges < self.most
            && self.until.is_none_or(|[until, _]| Instant::now() < until)
    }

    /// Counts an inspection and returns true if another one is allowed.
    #[inline]
    pub(crate) fn may_inspect_more(&mut self) -> bool {
        self.change.inspected += 1;
        !self.change.inspected.is_multiple_of(INSPECTIONS_PER_CLOCK)
            || self.until.is_none_or(|[_, until]| Instant::now() < until)
    }
}
