//! When to look at an update again: after the eye has travelled as far as it must before its need can
//! turn.
//!
//! A need turns where the eye crosses a sphere about the ball. Until then nothing has to be looked at,
//! so a frame costs what is close to turning and not what is there.

use crate::need::{Ball, Eye, PackedBall};

/// The finest step of the way, in stored units.
const FINEST: f64 = 1.0 / (1u64 << 30) as f64;
/// How many octaves of leeway are told apart; what has more is looked at when that is used up.
const OCTAVES: usize = 48;
/// Into how many steps an octave of leeway is parted: an entry is early by one of 16 to 32 at most.
const STEPS: i64 = 16;
/// An octave's entries are up to 32 steps ahead.
const RING: usize = 64;
/// A longer way begins anew, in stored units: then what is added to it is not lost in it.
const LONGEST: f64 = 1e3;
/// Of the way: an entry is early by so much, for rounding.
const SLACK: f64 = 1e-12;

/// An update as it was when it was looked at last, with all that it takes to see that nothing has
/// turned: most looks end there, and go nowhere else in memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) update: u32,
    /// The node that it splits.
    pub(super) node: u32,
    pub(super) ball: PackedBall,
    /// Whether it was wanted, and whether it might stay.
    pub(super) wanted: [bool; 2],
}

/// Updates by the way of the eye at which they are due.
///
/// An octave of leeway has steps of a length of its own, and a ring of lists, one for each step.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    eye: Option<Eye>,
    /// How far the eye has come.
    way: f64,
    rings: Vec<Vec<Entry>>,
    /// How many entries each octave has.
    counts: [usize; OCTAVES],
    /// What is due now.
    pub(super) due: Vec<Entry>,
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
    pub(super) fn follow(&mut self, eye: Option<Eye>) -> bool {
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

    /// Enters an update that has just been looked at; false where its need never turns, or nobody
    /// knows when.
    #[inline]
    pub(super) fn add(&mut self, entry: Entry, ball: &Ball, hysteresis: Option<f64>) -> bool {
        let Some(eye) = self.eye else { return false };
        let mut leeway = eye.leeway(ball);
        if let Some(part) = hysteresis {
            let stays = Eye { slope: eye.slope / (1.0 + part), ..eye };
            leeway = leeway.min(stays.leeway(ball));
        }
        if leeway == f64::INFINITY {
            return false;
        }
        let leeway = (leeway - SLACK * self.way).max(0.0);
        let steps = leeway / FINEST / STEPS as f64;
        let octave = ((steps as u64).max(1).ilog2() as usize).min(OCTAVES - 1);
        let most = (2 * STEPS) as f64 * length(octave);
        let at = step(self.way + leeway.min(most), octave);
        self.rings[slot(octave, at)].push(entry);
        self.counts[octave] += 1;
        true
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

fn length(octave: usize) -> f64 {
    FINEST * (1u64 << octave) as f64
}

fn step(way: f64, octave: usize) -> i64 {
    (way / length(octave)) as i64
}

fn slot(octave: usize, step: i64) -> usize {
    octave * RING + step as usize % RING
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::frame::Length16;

    #[test]
    fn nobody_is_late_and_few_are_early() {
        let eye = |x: f64| Some(Eye { at: DVec3::new(x, 0.0, 0.0), slope: 0.01 });
        let mut schedule = Schedule::default();
        assert!(!schedule.follow(eye(0.0)), "the first look is at everything");
        schedule.clear(|_| {});
        // The need of ball i turns when the eye has come to x = i³ / 1000.
        let at = |i: u32| f64::from(i).powi(3) / 1000.0;
        let ball =
            |i| Ball { center: DVec3::new(at(i) + 1.0, 0.0, 0.0), radius: 0.5, error: 0.005 };
        let packed = PackedBall { center: [0.0; 3], radius: Length16(0), error: Length16(0) };
        let entry = |update| Entry { update, node: update, ball: packed, wanted: [false; 2] };
        (0..60).for_each(|i| assert!(schedule.add(entry(i), &ball(i), None)));
        let mut looks = 0;
        let mut x = 0.0;
        for frame in 0..200 {
            x += 0.001 * f64::from(frame);
            assert!(schedule.follow(eye(x)));
            for Entry { update, .. } in std::mem::take(&mut schedule.due) {
                looks += 1;
                if at(update) <= x {
                    continue;
                }
                assert!(eye(x).unwrap().leeway(&ball(update)) > 0.0);
                schedule.add(entry(update), &ball(update), None);
            }
            assert!(schedule.rings.iter().flatten().all(|e| at(e.update) > x), "late at {x}");
        }
        // Each about as often as its leeway has sixteenths to be early by, again and again.
        assert!(looks < 60 * 12, "{looks}");
    }

    #[test]
    fn a_long_way_swallows_no_short_steps() {
        let eye = |x: f64| Some(Eye { at: DVec3::new(x, 0.0, 0.0), slope: 0.01 });
        let mut schedule = Schedule::default();
        schedule.follow(eye(0.0));
        schedule.clear(|_| {});
        assert!(schedule.follow(eye(499.0)) && schedule.follow(eye(0.0)));
        let ball = Ball { center: DVec3::new(1.0 + 1e-8, 0.0, 0.0), radius: 0.5, error: 0.005 };
        let packed = PackedBall { center: [0.0; 3], radius: Length16(0), error: Length16(0) };
        let entry = Entry { update: 0, node: 0, ball: packed, wanted: [false; 2] };
        assert!(schedule.add(entry, &ball, None));
        // Each is less than half of what can be added to so long a way.
        let steps = (0..).take_while(|&i| {
            assert!(schedule.follow(eye(5e-14 * f64::from(i))));
            schedule.due.is_empty()
        });
        assert!(steps.count() <= 200_000);
    }

    #[test]
    fn a_way_that_is_too_long_begins_anew() {
        let eye = |x: f64| Some(Eye { at: DVec3::new(x, 0.0, 0.0), slope: 0.01 });
        let mut schedule = Schedule::default();
        schedule.follow(eye(0.0));
        assert!(schedule.follow(eye(0.5 * LONGEST)) && !schedule.follow(eye(2.0 * LONGEST)));
        schedule.clear(|_| {});
        assert!(schedule.follow(eye(2.5 * LONGEST)));
    }

    #[test]
    fn another_slope_is_another_question() {
        let mut schedule = Schedule::default();
        let eye = Eye { at: DVec3::ZERO, slope: 0.01 };
        assert!(!schedule.follow(Some(eye)) && schedule.follow(Some(eye)));
        assert!(!schedule.follow(Some(Eye { slope: 0.02, ..eye })));
        assert!(!schedule.follow(None) && !schedule.follow(Some(eye)));
    }
}
