//! Vertices that are not where their node is: from what to what they move, and since when.
//!
//! All take equally long, so they arrive in the order in which they set out: as time passes, only those
//! that arrive are looked at.

use std::collections::VecDeque;
use std::time::Duration;

use rustc_hash::FxHashMap;

use super::VertexValues;
use super::vertex_values::Blend;

/// Motions of vertices, each from what it was when it set out to what it will be.
///
/// The order of slots depends on what was started and ended, and on nothing else.
#[derive(Clone, Debug)]
pub(super) struct Motions {
    slots: FxHashMap<u32, u32>,
    all: Vec<StoredMotion>,
    /// Values of all motions: for each those it set out with, then as many that it will have.
    values: Vec<f32>,
    /// Number of values that belong to no motion any more.
    unused: usize,
    /// Numbers of the motions under way and their vertices, in the order in which they set out.
    /// Those that have turned or gone since are passed over.
    under_way: VecDeque<(u64, u32)>,
    /// Number of the last motion.
    last: u64,
    /// Time that has passed.
    clock: Duration,
    /// Time that a motion takes.
    duration: Duration,
}

#[derive(Clone, Copy, Debug)]
struct StoredMotion {
    node: u32,
    /// Number of values at either end.
    count: u32,
    /// Start of its values in the list.
    start: usize,
    /// Its number, which rises from one to the next.
    number: u64,
    /// Time when it set out; `None` once it has arrived.
    begun: Option<Duration>,
    ends: [[f64; 3]; 2],
}

/// Motion of a vertex: what it was when it set out, and what it will be.
///
/// Positions and values in between are weighted means, by the part of the time that has passed. Values
/// of layers that are [not blended](meshlod_mesh::LayerKind::is_blended) change at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<'m> {
    /// Time when the vertex set out, by [`Geomorph::clock`](super::Geomorph::clock); `None` once it has
    /// arrived, and waits there until the cut no longer needs it.
    pub begun: Option<Duration>,
    /// Positions at both ends, in model units.
    pub positions: [[f64; 3]; 2],
    /// Values at both ends, as in [`VertexValues::values`].
    pub values: [&'m [f32]; 2],
}

/// Longest time that a motion may take, 136 years, so that clocks do not overflow.
const LONGEST: Duration = Duration::from_secs(u32::MAX as u64);

impl Motions {
    /// Creates an empty list of motions that take this long.
    pub(super) fn new(duration: Duration) -> Self {
        Self {
            slots: FxHashMap::default(),
            all: Vec::new(),
            values: Vec::new(),
            unused: 0,
            under_way: VecDeque::new(),
            last: 0,
            clock: Duration::ZERO,
            duration: duration.min(LONGEST),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    pub(super) fn clock(&self) -> Duration {
        self.clock
    }

    pub(super) fn duration(&self) -> Duration {
        self.duration
    }

    /// Iterates over the vertices, those included that have arrived and wait.
    pub(super) fn nodes(&self) -> impl Iterator<Item = u32> + '_ {
        self.all.iter().map(|motion| motion.node)
    }

    /// Lets time pass, and appends the vertices that arrive to `arrived`, in the order of their motions.
    pub(super) fn advance(&mut self, elapsed: Duration, arrived: &mut Vec<u32>) {
        // What is on its way arrives by then.
        self.clock = self.clock.saturating_add(elapsed.min(self.duration));
        while let Some(&(number, node)) = self.under_way.front() {
            let slot = self.slots.get(&node).map(|&slot| slot as usize);
            let motion = slot.map(|slot| &mut self.all[slot]);
            if let Some(motion) = motion.filter(|motion| motion.number == number) {
                if motion.begun.is_some_and(|begun| self.clock - begun < self.duration) {
                    return;
                }
                motion.begun = None;
                arrived.push(node);
            }
            self.under_way.pop_front();
        }
    }

    /// Returns true if a vertex has not arrived yet.
    #[inline]
    pub(super) fn is_under_way(&self, node: u32) -> bool {
        self.stored(node).is_some_and(|motion| motion.begun.is_some())
    }

    /// Returns true if a vertex is on its way to this state, or there.
    pub(super) fn leads_to(&self, node: u32, to: &VertexValues) -> bool {
        self.stored(node).is_some_and(|motion| {
            motion.ends[1] == to.position && self.ends(motion)[1] == to.values
        })
    }

    /// Returns the motion of a vertex; `None` if it is where its node is.
    #[inline]
    pub(super) fn get(&self, node: u32) -> Option<Motion<'_>> {
        self.stored(node).map(|motion| Motion {
            begun: motion.begun,
            positions: motion.ends,
            values: self.ends(motion),
        })
    }

    /// Writes what a vertex is now, and returns true if it is here.
    pub(super) fn now(&self, node: u32, blend: &Blend, to: &mut VertexValues) -> bool {
        let Some(motion) = self.get(node) else { return false };
        let weight = motion
            .begun
            .map_or(1.0, |begun| (self.clock - begun).as_secs_f64() / self.duration.as_secs_f64());
        blend.write(motion.positions, motion.values, weight, to);
        true
    }

    /// Sends a vertex from one state to another, of as many values, in place of where it was going.
    /// It arrives at once if they are the same, or if motions take no time.
    pub(super) fn send(&mut self, node: u32, [from, to]: [&VertexValues; 2]) {
        let is_there = from == to || self.duration.is_zero();
        self.put(node, [from, to], (!is_there).then_some(self.clock));
        if !is_there {
            self.under_way.push_back((self.last, node));
            self.forget_turns();
        }
    }

    /// Puts a vertex where it is not at home.
    pub(super) fn rest(&mut self, node: u32, at: &VertexValues) {
        self.put(node, [at, at], None);
    }

    fn put(&mut self, node: u32, [from, to]: [&VertexValues; 2], begun: Option<Duration>) {
        debug_assert_eq!(from.values.len(), to.values.len());
        let count = to.values.len();
        let slot = *self.slots.entry(node).or_insert(self.all.len() as u32) as usize;
        let start = match self.all.get(slot).filter(|old| old.count as usize == count) {
            Some(old) => old.start,
            None => self.values.len(),
        };
        self.values.resize(self.values.len().max(start + 2 * count), 0.0);
        self.values[start..start + count].copy_from_slice(&from.values);
        self.values[start + count..start + 2 * count].copy_from_slice(&to.values);
        let ends = [from.position, to.position];
        self.last += 1;
        let number = self.last;
        let motion = StoredMotion { node, count: count as u32, start, number, begun, ends };
        match self.all.get_mut(slot) {
            Some(old) => *old = motion,
            None => self.all.push(motion),
        }
    }

    /// Forgets motions that have turned or gone since, once they are the most.
    fn forget_turns(&mut self) {
        let Self { under_way, slots, all, .. } = self;
        if under_way.len() > 64 + 2 * all.len() {
            let number = |node: u32| slots.get(&node).map(|&slot| all[slot as usize].number);
            under_way.retain(|&(begun, node)| number(node) == Some(begun));
        }
    }

    /// Forgets a vertex, and returns true if it was here.
    pub(super) fn remove(&mut self, node: u32) -> bool {
        let Some(slot) = self.slots.remove(&node) else { return false };
        let removed = self.all.swap_remove(slot as usize);
        if let Some(moved) = self.all.get(slot as usize) {
            self.slots.insert(moved.node, slot);
        }
        self.unused += 2 * removed.count as usize;
        if 2 * self.unused > self.values.len() {
            self.close_gaps();
        }
        true
    }

    /// Moves values together.
    fn close_gaps(&mut self) {
        let mut values = Vec::with_capacity(self.values.len() - self.unused);
        for motion in &mut self.all {
            let old = motion.start..motion.start + 2 * motion.count as usize;
            motion.start = values.len();
            values.extend_from_slice(&self.values[old]);
        }
        (self.values, self.unused) = (values, 0);
    }

    #[inline]
    fn stored(&self, node: u32) -> Option<&StoredMotion> {
        self.slots.get(&node).map(|&slot| &self.all[slot as usize])
    }

    /// Returns the values that a motion has at its two ends.
    fn ends(&self, motion: &StoredMotion) -> [&[f32]; 2] {
        let count = motion.count as usize;
        let (from, to) = self.values[motion.start..motion.start + 2 * count].split_at(count);
        [from, to]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn state(x: f64, values: &[f32]) -> VertexValues {
        VertexValues { position: [x, 0.0, 0.0], values: values.to_vec() }
    }

    fn arrive(all: &mut Motions, elapsed: Duration) -> Vec<u32> {
        let mut arrived = Vec::new();
        all.advance(elapsed, &mut arrived);
        arrived
    }

    #[test]
    fn vertices_keep_their_values_when_others_go() {
        let (mut all, blend) = (Motions::new(SECOND), Blend::new(std::iter::empty()));
        for node in 0..100 {
            let (from, to) = (vec![node as f32; node % 3], vec![-1.0; node % 3]);
            all.send(node as u32, [&state(0.0, &from), &state(node as f64 + 1.0, &to)]);
        }
        // One stays, elsewhere.
        all.rest(50, &state(7.0, &[7.0; 2]));
        assert!(all.leads_to(50, &state(7.0, &[7.0; 2])) && !all.is_under_way(50));
        (0..100).filter(|node| node % 7 > 0).for_each(|node| assert!(all.remove(node)));
        assert!(!all.remove(1) && !all.is_under_way(1) && all.get(1).is_none());
        assert!(all.values.len() < 60, "{} values", all.values.len());
        let mut now = VertexValues::default();
        for node in (0..100).step_by(7) {
            assert!(all.is_under_way(node) && all.now(node, &blend, &mut now));
            assert_eq!(now, state(0.0, &vec![node as f32; node as usize % 3]));
        }
        assert_eq!(arrive(&mut all, Duration::MAX), Vec::from_iter((0..100).step_by(7)));
        assert!(all.now(49, &blend, &mut now) && !all.is_under_way(49));
        assert_eq!(now, state(50.0, &[-1.0]));
    }

    #[test]
    fn vertices_arrive_when_their_time_has_passed_since_they_last_set_out() {
        let mut all = Motions::new(SECOND);
        let [here, there] = [state(0.0, &[]), state(1.0, &[])];
        (0..4).for_each(|node| all.send(node, [&here, &there]));
        assert_eq!(arrive(&mut all, SECOND / 2), [0; 0]);
        all.send(1, [&there, &here]);
        all.send(4, [&here, &here]);
        all.remove(2);
        assert!(!all.is_under_way(4), "it is there already");
        assert_eq!(arrive(&mut all, SECOND / 2), [0, 3]);
        assert_eq!(arrive(&mut all, SECOND / 2), [1]);
        all.send(2, [&here, &there]);
        assert_eq!(arrive(&mut all, Duration::MAX), [2]);
        let mut longest = Motions::new(Duration::MAX);
        for _ in 0..9 {
            longest.send(0, [&here, &there]);
            assert_eq!(arrive(&mut longest, SECOND), [0; 0]);
            assert_eq!(arrive(&mut longest, Duration::MAX), [0]);
        }
        let mut at_once = Motions::new(Duration::ZERO);
        at_once.send(0, [&here, &there]);
        assert!(!at_once.is_under_way(0) && at_once.leads_to(0, &there));
    }

    #[test]
    fn vertices_that_turn_for_ever_take_no_more_room() {
        let mut all = Motions::new(SECOND);
        let [here, there] = [state(0.0, &[0.0]), state(1.0, &[1.0])];
        for turn in 0..10_000 {
            let ends = if turn % 2 == 0 { [&here, &there] } else { [&there, &here] };
            all.send(turn % 3, ends);
            if turn % 5 == 0 {
                all.remove(turn % 3);
            }
        }
        assert!(all.under_way.len() < 100 && all.values.len() <= 12);
    }
}
