//! Selection of the keys that interpolation of the others cannot reproduce within the tolerance.

use super::key_track::{KeyTrack, KeyValue, arc, distance, nearer, slerp};

/// Limit on the number of keys replaced by one interval; bounds the time of [`select`].
const MOST_KEYS: usize = 256;

/// Track with the rounded poses of its keys.
pub(crate) struct RoundedTrack {
    pub track: KeyTrack,
    /// Rounded pose of every key.
    pub rounded: Vec<KeyValue>,
    /// Largest allowed distance between poses, as points in space.
    pub tolerance: f64,
}

impl RoundedTrack {
    /// Reports whether the first key is close enough to all others.
    pub fn is_constant(&self) -> bool {
        let Self { track, rounded, .. } = self;
        (1..track.poses.len()).all(|key| self.joins(key, rounded[0], rounded[0]))
            && self.is_near(track.poses[0], rounded[0])
    }

    /// Reports whether the poses between two keys are close to their interpolation.
    fn spans(&self, from: usize, to: usize) -> bool {
        let Self { track, rounded, .. } = self;
        if track.is_step {
            return (from..to).all(|key| self.is_near(track.poses[key], rounded[from]))
                && self.is_near(track.poses[to], rounded[to]);
        }
        let time = |key: usize| f64::from(track.times[key]);
        let part = |key| (time(key) - time(from)) / (time(to) - time(from));
        let (a, b) = (rounded[from], rounded[to]);
        (from + 1..=to).all(|key| {
            let at = |key| track.between(a, b, part(key));
            self.joins(key, at(key - 1), at(key))
        })
    }

    /// Reports whether the path from key `key - 1` to `key` is close to the path from `a` to `b`.
    ///
    /// Vectors differ most at one of the ends. Rotations go along arcs of constant speed, so the
    /// second derivative of their difference is at most the sum of the squares of the arcs, and
    /// between samples the difference exceeds theirs by an eighth of that at most.
    fn joins(&self, key: usize, a: KeyValue, b: KeyValue) -> bool {
        let [from, to] = [self.track.poses[key - 1], self.track.poses[key]];
        if self.track.is_step || !self.track.is_rotation() {
            return self.is_near(from, a) && self.is_near(to, b);
        }
        let from = nearer(a, from);
        let to = nearer(from, to);
        let bend = (arc(from, to).powi(2) + arc(a, b).powi(2)) / 8.0;
        let samples = (16.0 * bend / self.tolerance).sqrt().ceil().clamp(1.0, 1e4);
        let beyond = bend / (samples * samples);
        (0..=samples as usize).all(|i| {
            let part = i as f64 / samples;
            distance(slerp(from, to, part), slerp(a, b, part)) + beyond <= self.tolerance
        })
    }

    fn is_near(&self, a: KeyValue, b: KeyValue) -> bool {
        let b = if self.track.is_rotation() { nearer(a, b) } else { b };
        distance(a, b) <= self.tolerance
    }
}

/// Selects the keys to keep in tracks with the same times, including the first and last.
///
/// Intervals are as long as the tolerance of every track allows, as far as doubling finds. `None`
/// if a track is not close to its rounded poses even with all its keys. Cost: O(n log m) for n keys
/// of all tracks, m = [`MOST_KEYS`].
pub(crate) fn select(tracks: &[&RoundedTrack]) -> Option<Vec<usize>> {
    let count = tracks.first()?.track.times.len();
    let mut keys = vec![0];
    let mut from = 0;
    while from + 1 < count {
        let most = MOST_KEYS.min(count - 1 - from);
        from += longest(most, |keys| tracks.iter().all(|track| track.spans(from, from + keys)))?;
        keys.push(from);
    }
    Some(keys)
}

/// Finds the largest number up to `most` for which `holds`, by doubling and bisection; `None` if it
/// does not hold for 1.
fn longest(most: usize, holds: impl Fn(usize) -> bool) -> Option<usize> {
    let mut good = holds(1).then_some(1)?;
    let mut bad = most + 1;
    while good + 1 < bad {
        let next = if bad > most { (2 * good).min(most) } else { good.midpoint(bad) };
        if holds(next) {
            good = next;
        } else {
            bad = next;
        }
    }
    Some(good)
}
