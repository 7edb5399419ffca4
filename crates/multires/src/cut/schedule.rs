//! Schedule of the inspections: an update need not be inspected again before the viewpoint has
//! travelled far enough to change its decision.
//!
//! A decision changes where the viewpoint crosses a sphere about the ball. Until it could have done
//! so the update is left alone, so the cost of a frame depends on the updates close to a change and
//! not on the size of the mesh.

use glam::Vec3;

use crate::query::{Criterion, QueryKey, Viewpoint};

/// The finest step is 2⁻³⁰ units of distance.
const FINEST_EXPONENT: u64 = 30;
const PER_FINEST: f64 = (1u64 << FINEST_EXPONENT) as f64;
/// Number of octaves of slack; entries with more are inspected again when it is used up.
const OCTAVES: usize = 48;
/// Steps per octave of slack: an entry is early by one part in 16 to 32 at most.
const STEPS: i64 = 16;
/// An octave's entries are up to 32 steps ahead.
const RING: usize = 64;
/// Distance, in stored units, after which the schedule starts anew, so that short steps are not
/// lost in the sum.
const LONGEST_PATH: f64 = 1e3;
/// Fraction of the way and the distance by which an entry is early, to allow for rounding.
const SLACK: f64 = 1e-12;

/// An inspected update with all that is needed to confirm its decision, so that most inspections
/// touch no other memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScheduleEntry {
    pub(crate) update: u32,
    /// Node that the update splits.
    pub(crate) node: u32,
    pub(crate) center: [f32; 3],
    /// Distances between which the decision does not change.
    pub(crate) span: Span,
}

/// Open interval of distances, rounded inwards.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span(f32, f32);

impl Span {
    pub(crate) const NEVER_TURNS: Self = Self(f32::NEG_INFINITY, f32::INFINITY);

    /// Distances less than the given one.
    pub(crate) fn below(distance: f64) -> Self {
        Self::NEVER_TURNS.and_below(distance)
    }

    /// Distances greater than the given one.
    pub(crate) fn above(distance: f64) -> Self {
        // `next_up` leaves infinity as it is.
        Self((distance as f32).next_up(), f32::INFINITY)
    }

    /// Restricts the interval to distances less than the given one.
    pub(crate) fn and_below(self, distance: f64) -> Self {
        let most = if distance.is_finite() { (distance as f32).next_down() } else { f32::INFINITY };
        Self(self.0, most)
    }
}

/// Updates by the length of the viewpoint's path at which they are due.
///
/// Each octave of slack has its own step length and a ring buffer of lists, one per step.
#[derive(Clone, Debug)]
pub(crate) struct Schedule {
    viewpoint: Option<Viewpoint>,
    /// Identity of the last query, to recognize it when it comes again.
    last: Option<QueryKey>,
    /// Length of the path so far.
    path: f64,
    rings: Vec<Vec<ScheduleEntry>>,
    /// Number of entries in each octave.
    counts: [usize; OCTAVES],
    /// Entries due now.
    pub(crate) due: Vec<ScheduleEntry>,
}

impl Default for Schedule {
    fn default() -> Self {
        let rings = vec![Vec::new(); OCTAVES * RING];
        Self {
            viewpoint: None,
            last: None,
            path: 0.0,
            rings,
            counts: [0; OCTAVES],
            due: Vec::new(),
        }
    }
}

impl Schedule {
    /// Takes up the next query. Returns true if it goes on from the last one, by a motion of the
    /// viewpoint or because it is the same; only updates that are due or waiting can change then.
    pub(crate) fn goes_on(&mut self, criterion: &Criterion<'_>) -> bool {
        let last = std::mem::replace(&mut self.last, criterion.key());
        let is_same = last.is_some() && last == self.last;
        self.follow(criterion.viewpoint()) || is_same
    }

    /// Moves the viewpoint and collects the entries that are due. Returns false if the query is of
    /// another kind, or the path too long, so that everything has to be inspected.
    fn follow(&mut self, viewpoint: Option<Viewpoint>) -> bool {
        let last = std::mem::replace(&mut self.viewpoint, viewpoint);
        let (Some(last), Some(viewpoint)) = (last, viewpoint) else { return false };
        if last.slope != viewpoint.slope {
            return false;
        }
        let from = self.path;
        let step = last.at.distance(viewpoint.at);
        if step > 0.0 {
            // Rounded up at every step, however many and short they are.
            self.path = (self.path + step * (1.0 + SLACK)).next_up();
        }
        if self.path.is_nan() || self.path > LONGEST_PATH {
            return false;
        }
        for octave in 0..OCTAVES {
            if self.counts[octave] > 0 {
                self.collect(octave, from);
            }
        }
        true
    }

    /// Makes the next query inspect everything.
    pub(crate) fn forget(&mut self) {
        (self.viewpoint, self.last) = (None, None);
    }

    /// Removes all entries and reports their nodes.
    pub(crate) fn clear(&mut self, mut out: impl FnMut(u32)) {
        self.path = 0.0;
        self.counts = [0; OCTAVES];
        let all = self.rings.iter_mut().chain([&mut self.due]);
        all.flat_map(|list| list.drain(..)).for_each(|entry| out(entry.node));
    }

    /// Schedules an update that has just been inspected. Returns false if its decision never
    /// changes.
    pub(crate) fn add(&mut self, entry: ScheduleEntry) -> bool {
        let Some(slack) = self.slack(&entry) else { return false };
        if slack < f64::INFINITY {
            self.enter(entry, slack.max(0.0));
        }
        slack < f64::INFINITY
    }

    /// Reschedules an update and returns true, if its decision cannot have changed.
    #[inline]
    pub(crate) fn add_again(&mut self, entry: ScheduleEntry) -> bool {
        let slack = self.slack(&entry).filter(|slack| *slack > 0.0);
        if let Some(slack) = slack {
            self.enter(entry, slack);
        }
        slack.is_some()
    }

    /// Returns the distance that the viewpoint may move before the decision can change.
    #[inline]
    fn slack(&self, entry: &ScheduleEntry) -> Option<f64> {
        let distance = self.viewpoint?.at.distance(Vec3::from(entry.center).as_dvec3());
        let Span(least, most) = entry.span;
        let slack = (distance - f64::from(least)).min(f64::from(most) - distance);
        Some(slack - SLACK * (distance + self.path))
    }

    #[inline]
    fn enter(&mut self, entry: ScheduleEntry, slack: f64) {
        let steps = slack * (PER_FINEST / STEPS as f64);
        let octave = ((steps as i64).max(1).ilog2() as usize).min(OCTAVES - 1);
        let most = (2 * STEPS) as f64 / per_length(octave);
        let at = step(self.path + slack.min(most), octave);
        self.rings[slot(octave, at)].push(entry);
        self.counts[octave] += 1;
    }

    /// Collects the entries that became due since `from`.
    fn collect(&mut self, octave: usize, from: f64) {
        let (from, to) = (step(from, octave), step(self.path, octave));
        // Only in the finest octave can an entry be in the step in which it was added.
        let from = if octave == 0 { from } else { from + 1 };
        for at in from.max(to - RING as i64 + 1)..=to {
            let list = &mut self.rings[slot(octave, at)];
            self.counts[octave] -= list.len();
            self.due.append(list);
        }
    }
}

/// Returns the number of steps of an octave per unit of distance, a power of two.
#[inline]
fn per_length(octave: usize) -> f64 {
    f64::from_bits((1023 + FINEST_EXPONENT - octave as u64) << 52)
}

#[inline]
fn step(path: f64, octave: usize) -> i64 {
    (path * per_length(octave)) as i64
}

#[inline]
fn slot(octave: usize, step: i64) -> usize {
    octave * RING + step as usize % RING
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn no_entry_is_late_and_few_are_early() {
        let viewpoint = |x: f64| Some(Viewpoint { at: DVec3::new(x, 0.0, 0.0), slope: 0.01 });
        let mut schedule = Schedule::default();
        assert!(!schedule.follow(viewpoint(0.0)), "the first look is at everything");
        schedule.clear(|_| {});
        // The decision on update i changes once the viewpoint is at about x = i³ / 1000.
        let center = |i: u32| [(f64::from(i).powi(3) / 1000.0 + 1.0) as f32, 0.0, 0.0];
        let at = |i: u32| f64::from(center(i)[0]) - 1.0;
        let entry =
            |i| ScheduleEntry { update: i, node: i, center: center(i), span: Span::above(1.0) };
        (0..60).for_each(|i| assert!(schedule.add(entry(i))));
        let mut looks = 0;
        let mut x = 0.0;
        for frame in 0..200 {
            x += 0.001 * f64::from(frame);
            assert!(schedule.follow(viewpoint(x)));
            for ScheduleEntry { update, .. } in std::mem::take(&mut schedule.due) {
                looks += 1;
                if at(update) <= x {
                    continue;
                }
                schedule.add(entry(update));
            }
            assert!(schedule.rings.iter().flatten().all(|e| at(e.update) > x), "late at {x}");
        }
        // Each is inspected about as often as its slack, again and again, has sixteenths to be
        // early by.
        assert!(looks < 60 * 12, "{looks}");
    }

    #[test]
    fn a_long_path_swallows_no_short_steps() {
        let viewpoint = |x: f64| Some(Viewpoint { at: DVec3::new(x, 0.0, 0.0), slope: 0.01 });
        let mut schedule = Schedule::default();
        schedule.follow(viewpoint(0.0));
        schedule.clear(|_| {});
        let start = 1.1e-7;
        assert!(schedule.follow(viewpoint(499.0)) && schedule.follow(viewpoint(start)));
        let [from, to] = [Span::above(1.0), Span::below(1.0)].map(|span| [span.0, span.1]);
        assert!(from[0] > 1.0 && to[1] < 1.0, "rounded inwards");
        let center = [1.0 + 2.0 * f32::EPSILON, 0.0, 0.0];
        let entry = ScheduleEntry { update: 0, node: 0, center, span: Span::above(1.0) };
        assert!(schedule.add(entry));
        // A slack of 9e-9, in steps that would each be lost if added to so long a path.
        let steps = (0..400_000).take_while(|&i| {
            assert!(schedule.follow(viewpoint(start + 5e-14 * f64::from(i))));
            schedule.due.is_empty()
        });
        let steps = steps.count();
        assert!((1000..=200_000).contains(&steps), "{steps}");
    }

    #[test]
    fn a_path_that_is_too_long_starts_anew() {
        let viewpoint = |x: f64| Some(Viewpoint { at: DVec3::new(x, 0.0, 0.0), slope: 0.01 });
        let mut schedule = Schedule::default();
        schedule.follow(viewpoint(0.0));
        assert!(
            schedule.follow(viewpoint(0.5 * LONGEST_PATH))
                && !schedule.follow(viewpoint(2.0 * LONGEST_PATH))
        );
        schedule.clear(|_| {});
        assert!(schedule.follow(viewpoint(2.5 * LONGEST_PATH)));
    }

    #[test]
    fn another_slope_is_another_query() {
        let mut schedule = Schedule::default();
        let viewpoint = Viewpoint { at: DVec3::ZERO, slope: 0.01 };
        assert!(!schedule.follow(Some(viewpoint)) && schedule.follow(Some(viewpoint)));
        assert!(!schedule.follow(Some(Viewpoint { slope: 0.02, ..viewpoint })));
        assert!(!schedule.follow(None) && !schedule.follow(Some(viewpoint)));
    }
}
