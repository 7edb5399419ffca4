//! Vertices under way, in slots, with their values in one list.

use std::time::Duration;

use rustc_hash::FxHashMap;

use super::VertexValues;
use super::vertex_values::Blend;

/// Motions of vertices, each from what it was when it set out to what it will be.
///
/// The order of slots depends on what was started and ended, and on nothing else.
#[derive(Clone, Debug, Default)]
pub(super) struct Motions {
    slots: FxHashMap<u32, u32>,
    all: Vec<Motion>,
    /// Values of all motions: for each those it set out with, then as many that it will have.
    values: Vec<f32>,
    /// Number of values that belong to no motion any more.
    unused: usize,
}

#[derive(Clone, Copy, Debug)]
struct Motion {
    node: u32,
    /// Number of values at either end.
    count: u32,
    /// Start of its values in the list.
    start: usize,
    elapsed: Duration,
    ends: [[f64; 3]; 2],
}

impl Motions {
    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Iterates over the vertices.
    pub(super) fn nodes(&self) -> impl Iterator<Item = u32> + '_ {
        self.all.iter().map(|motion| motion.node)
    }

    /// Lets time pass, and forgets the vertices that have arrived and that `ends` accepts.
    pub(super) fn advance(
        &mut self,
        elapsed: Duration,
        duration: Duration,
        mut ends: impl FnMut(u32) -> bool,
    ) {
        for motion in &mut self.all {
            motion.elapsed = motion.elapsed.saturating_add(elapsed);
        }
        let mut slot = 0;
        while let Some(&Motion { node, elapsed, .. }) = self.all.get(slot) {
            if elapsed >= duration && ends(node) {
                // Another one takes its slot.
                self.remove(node);
            } else {
                slot += 1;
            }
        }
    }

    /// Returns true if a vertex has not arrived yet.
    #[inline]
    pub(super) fn is_under_way(&self, node: u32, duration: Duration) -> bool {
        self.get(node).is_some_and(|motion| motion.elapsed < duration)
    }

    /// Returns true if a vertex has arrived, but is not forgotten.
    pub(super) fn is_over(&self, node: u32, duration: Duration) -> bool {
        self.get(node).is_some_and(|motion| motion.elapsed >= duration)
    }

    /// Returns true if a vertex is on its way to this state.
    pub(super) fn leads_to(&self, node: u32, to: &VertexValues) -> bool {
        self.get(node).is_some_and(|motion| {
            motion.ends[1] == to.position && self.ends(motion)[1] == to.values
        })
    }

    /// Writes what a vertex is now, and returns true if it is here.
    pub(super) fn now(
        &self,
        node: u32,
        duration: Duration,
        blend: &Blend,
        to: &mut VertexValues,
    ) -> bool {
        let Some(motion) = self.get(node) else { return false };
        let weight = match motion.elapsed >= duration {
            true => 1.0,
            false => motion.elapsed.as_secs_f64() / duration.as_secs_f64(),
        };
        blend.write(motion.ends, self.ends(motion), weight, to);
        true
    }

    /// Sends a vertex from one state to another, of as many values, in place of where it was going.
    pub(super) fn send(&mut self, node: u32, [from, to]: [&VertexValues; 2], elapsed: Duration) {
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
        let motion = Motion { node, count: count as u32, start, elapsed, ends };
        match self.all.get_mut(slot) {
            Some(old) => *old = motion,
            None => self.all.push(motion),
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
    fn get(&self, node: u32) -> Option<&Motion> {
        self.slots.get(&node).map(|&slot| &self.all[slot as usize])
    }

    /// Returns the values that a motion has at its two ends.
    fn ends(&self, motion: &Motion) -> [&[f32]; 2] {
        let count = motion.count as usize;
        let (from, to) = self.values[motion.start..motion.start + 2 * count].split_at(count);
        [from, to]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(x: f64, values: &[f32]) -> VertexValues {
        VertexValues { position: [x, 0.0, 0.0], values: values.to_vec() }
    }

    #[test]
    fn vertices_keep_their_values_when_others_go() {
        let (second, mut all) = (Duration::from_secs(1), Motions::default());
        let blend = Blend::new(std::iter::empty());
        for node in 0..100 {
            let (from, to) = (vec![node as f32; node % 3], vec![-1.0; node % 3]);
            let ends = [state(0.0, &from), state(node as f64, &to)];
            all.send(node as u32, [&ends[0], &ends[1]], Duration::ZERO);
        }
        // Some set out again, from elsewhere.
        let ends = [state(5.0, &[5.0; 2]), state(7.0, &[7.0; 2])];
        all.send(50, [&ends[0], &ends[1]], second);
        assert!(all.leads_to(50, &ends[1]) && all.is_over(50, second));
        (0..100).filter(|node| node % 7 > 0).for_each(|node| assert!(all.remove(node)));
        assert!(!all.remove(1) && !all.is_over(1, Duration::ZERO));
        assert!(all.values.len() < 60, "{} values", all.values.len());
        let mut now = VertexValues::default();
        for node in (0..100).step_by(7) {
            assert!(all.is_under_way(node, second));
            assert!(all.now(node, second, &blend, &mut now));
            assert_eq!(now, state(0.0, &vec![node as f32; node as usize % 3]));
        }
        let mut ended = Vec::new();
        all.advance(second, second, |node| {
            ended.push(node);
            node != 49
        });
        ended.sort_unstable();
        assert!(ended.iter().copied().eq((0..100).step_by(7)), "{ended:?}");
        assert_eq!(all.nodes().collect::<Vec<_>>(), [49]);
        assert!(all.now(49, second, &blend, &mut now));
        assert_eq!(now, state(49.0, &[-1.0]));
    }
}
