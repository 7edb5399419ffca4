//! When to look at an update again: after the eye has travelled as far as it must before its need can
//! turn.
//!
//! A need turns where the eye crosses a sphere about the ball. Until then nothing has to be looked at,
//! so a frame costs what is close to turning and not what is there.

use glam::Vec3;

use crate::query::Viewpoint;

/// A unit of the way has 2³⁰ of the finest steps.
const FINEST_EXPONENT: u64 = 30;
const PER_FINEST: f64 = (1u64 << FINEST_EXPONENT) as f64;
/// How many octaves of leeway are told apart; what has more is looked at when that is used up.
const OCTAVES: usize = 48;
/// Into how many steps an octave of leeway is parted: an entry is early by one of 16 to 32 at most.
const STEPS: i64 = 16;
/// An octave's entries are up to 32 steps ahead.
const RING: usize = 64;
/// A longer way begins anew, in stored units: then what is added to it is not lost in it.
const LONGEST: f64 = 1e3;
/// Of the way and the distance: an entry is early by so much, for rounding.
const SLACK: f64 = 1e-12;

/// An update that was looked at, with all that it takes to see that nothing has turned: most looks end
/// there, and go nowhere else in memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScheduleEntry {
    pub(super) update: u32,
    /// The node that it splits.
    pub(super) node: u32,
    pub(super) center: [f32; 3],
    /// Between which distances the eye sees nothing turn.
    pub(super) span: Span,
}

/// More than the first and less than the second, rounded inwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span(f32, f32);

impl Span {
    pub(super) const NEVER_TURNS: Self = Self(f32::NEG_INFINITY, f32::INFINITY);

    /// While the eye is closer.
    pub(super) fn below(distance: f64) -> Self {
        Self::NEVER_TURNS.and_below(distance)
    }

    /// While the eye is further away.
    pub(super) fn above(distance: f64) -> Self {
        // Infinity does not get larger.
        Self((distance as f32).next_up(), f32::INFINITY)
    }

    /// And closer than this.
    pub(super) fn and_below(self, distance: f64) -> Self {
        let most = if distance.is_finite() { (distance as f32).next_down() } else { f32::INFINITY };
        Self(self.0, most)
    }
}

/// Updates by the way of the eye at which they are due.
///
/// An octave of leeway has steps of a length of its own, and a ring of lists, one for each step.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    eye: Option<Viewpoint>,
    /// How far the eye has come.
    way: f64,
    rings: Vec<Vec<ScheduleEntry>>,
    /// How many entries each octave has.
    counts: [usize; OCTAVES],
    /// What is due now.
    pub(super) due: Vec<ScheduleEntry>,
}

impl Default for Schedule {
    fn default() -> Self {
        let rings = vec![Vec::new(); OCTAVES * RING];
        Self { eye: None, way: 0.0, rings, counts: [0; OCTAVES], due: Vec::new() }
    }
}

impl Schedule {
    /// Goes where the eye is now and collects what is due; false where it is another eye, or where it
    /// is not the eye that matters: then all must be looked at.
    pub(super) fn follow(&mut self, eye: Option<Viewpoint>) -> bool {
        let last = std::mem::replace(&mut self.eye, eye);
        let (Some(last), Some(eye)) = (last, eye) else { return false };
        if last.slope != eye.slope {
            return false;
        }
        let from = self.way;
        let step = last.at.distance(eye.at);
        if step > 0.0 {
            // Rather too far than not far enough, however many and short the steps are.
            self.way = (self.way + step * (1.0 + SLACK)).next_up();
        }
        if self.way.is_nan() || self.way > LONGEST {
            return false;
        }
        for octave in 0..OCTAVES {
            if self.counts[octave] > 0 {
                self.collect(octave, from);
            }
        }
        true
    }

    /// Makes the next query look at everything.
    pub(super) fn forget(&mut self) {
        self.eye = None;
    }

    /// Takes out everything, and tells the nodes.
    pub(super) fn clear(&mut self, mut out: impl FnMut(u32)) {
        self.way = 0.0;
        self.counts = [0; OCTAVES];
        let all = self.rings.iter_mut().chain([&mut self.due]);
        all.flat_map(|list| list.drain(..)).for_each(|entry| out(entry.node));
    }

    /// Enters an update that has just been looked at, if it may turn.
    pub(super) fn add(&mut self, entry: ScheduleEntry) -> bool {
        let Some(leeway) = self.leeway(&entry) else { return false };
        if leeway < f64::INFINITY {
            self.enter(entry, leeway.max(0.0));
        }
        leeway < f64::INFINITY
    }

    /// Enters an update again if it cannot have turned.
    #[inline]
    pub(super) fn add_again(&mut self, entry: ScheduleEntry) -> bool {
        let leeway = self.leeway(&entry).filter(|leeway| *leeway > 0.0);
        if let Some(leeway) = leeway {
            self.enter(entry, leeway);
        }
        leeway.is_some()
    }

    /// How far the eye may move before an update may turn.
    #[inline]
    fn leeway(&self, entry: &ScheduleEntry) -> Option<f64> {
        let distance = self.eye?.at.distance(Vec3::from(entry.center).as_dvec3());
        let Span(least, most) = entry.span;
        let leeway = (distance - f64::from(least)).min(f64::from(most) - distance);
        Some(leeway - SLACK * (distance + self.way))
    }

    #[inline]
    fn enter(&mut self, entry: ScheduleEntry, leeway: f64) {
        let steps = leeway * (PER_FINEST / STEPS as f64);
        let octave = ((steps as i64).max(1).ilog2() as usize).min(OCTAVES - 1);
        let most = (2 * STEPS) as f64 / per_length(octave);
        let at = step(self.way + leeway.min(most), octave);
        self.rings[slot(octave, at)].push(entry);
        self.counts[octave] += 1;
    }

    /// Collects what became due on the way to here.
    fn collect(&mut self, octave: usize, from: f64) {
        let (from, to) = (step(from, octave), step(self.way, octave));
        // Only the finest steps are so long that an entry may be in the one that it was made in.
        let from = if octave == 0 { from } else { from + 1 };
        for at in from.max(to - RING as i64 + 1)..=to {
            let list = &mut self.rings[slot(octave, at)];
            self.counts[octave] -= list.len();
            self.due.append(list);
        }
    }
}

/// How many of an octave's steps a unit of the way has: a power of two.
#[inline]
fn per_length(octave: usize) -> f64 {
    f64::from_bits((1023 + FINEST_EXPONENT - octave as u64) << 52)
}

#[inline]
fn step(way: f64, octave: usize) -> i64 {
    (way * per_length(octave)) as i64
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
    fn nobody_is_late_and_few_are_early() {
        let eye = |x: f64| Some(Viewpoint { at: DVec3::new(x, 0.0, 0.0), slope: 0.01 });
        let mut schedule = Schedule::default();
        assert!(!schedule.follow(eye(0.0)), "the first look is at everything");
        schedule.clear(|_| {});
        // Update i turns when the eye has come to about x = i³ / 1000.
        let center = |i: u32| [(f64::from(i).powi(3) / 1000.0 + 1.0) as f32, 0.0, 0.0];
        let at = |i: u32| f64::from(center(i)[0]) - 1.0;
        let entry =
            |i| ScheduleEntry { update: i, node: i, center: center(i), span: Span::above(1.0) };
        (0..60).for_each(|i| assert!(schedule.add(entry(i))));
        let mut looks = 0;
        let mut x = 0.0;
        for frame in 0..200 {
            x += 0.001 * f64::from(frame);
            assert!(schedule.follow(eye(x)));
            for ScheduleEntry { update, .. } in std::mem::take(&mut schedule.due) {
                looks += 1;
                if at(update) <= x {
                    continue;
                }
                schedule.add(entry(update));
            }
            assert!(schedule.rings.iter().flatten().all(|e| at(e.update) > x), "late at {x}");
        }
        // Each about as often as its leeway has sixteenths to be early by, again and again.
        assert!(looks < 60 * 12, "{looks}");
    }

    #[test]
    fn a_long_way_swallows_no_short_steps() {
        let eye = |x: f64| Some(Viewpoint { at: DVec3::new(x, 0.0, 0.0), slope: 0.01 });
        let mut schedule = Schedule::default();
        schedule.follow(eye(0.0));
        schedule.clear(|_| {});
        let start = 1.1e-7;
        assert!(schedule.follow(eye(499.0)) && schedule.follow(eye(start)));
        let [from, to] = [Span::above(1.0), Span::below(1.0)].map(|span| [span.0, span.1]);
        assert!(from[0] > 1.0 && to[1] < 1.0, "rounded inwards");
        let center = [1.0 + 2.0 * f32::EPSILON, 0.0, 0.0];
        let entry = ScheduleEntry { update: 0, node: 0, center, span: Span::above(1.0) };
        assert!(schedule.add(entry));
        // A leeway of 9e-9, in steps of which each is lost when it is added to so long a way.
        let steps = (0..400_000).take_while(|&i| {
            assert!(schedule.follow(eye(start + 5e-14 * f64::from(i))));
            schedule.due.is_empty()
        });
        let steps = steps.count();
        assert!((1000..=200_000).contains(&steps), "{steps}");
    }

    #[test]
    fn a_way_that_is_too_long_begins_anew() {
        let eye = |x: f64| Some(Viewpoint { at: DVec3::new(x, 0.0, 0.0), slope: 0.01 });
        let mut schedule = Schedule::default();
        schedule.follow(eye(0.0));
        assert!(schedule.follow(eye(0.5 * LONGEST)) && !schedule.follow(eye(2.0 * LONGEST)));
        schedule.clear(|_| {});
        assert!(schedule.follow(eye(2.5 * LONGEST)));
    }

    #[test]
    fn another_slope_is_another_question() {
        let mut schedule = Schedule::default();
        let eye = Viewpoint { at: DVec3::ZERO, slope: 0.01 };
        assert!(!schedule.follow(Some(eye)) && schedule.follow(Some(eye)));
        assert!(!schedule.follow(Some(Viewpoint { slope: 0.02, ..eye })));
        assert!(!schedule.follow(None) && !schedule.follow(Some(eye)));
    }
}
