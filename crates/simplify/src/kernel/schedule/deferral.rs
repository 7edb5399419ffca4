//! Deferral of contractions that deviate much farther than is usual at the front.
//!
//! The queue is ordered by squared swept volumes, in which the tip of a spike is next to nothing,
//! however long it is. A contraction that goes much farther than others is deferred until that
//! distance is usual. This changes the order, and no target is missed.

use crate::kernel::metric::VOLUME_SHARE;
use crate::kernel::schedule::bucket_queue::{bucket, last_bucket, min_cost_in};

/// Multiple of the usual squared distance that is too far. Geometric means over four levels of
/// nineteen models, relative to 4: 3 1.02 in the mean, .95 in the maximum (both with a
/// [`NEGLIGIBLE`] of 1e-4); 5 1.01, 1.12. Greatest distances of horse-97k and igea at 10 %: 3 .101,
/// .062; 4 .111, .069; 5 .098, .062; 6 .123, .067.
const TOO_FAR: f32 = 4.0;

/// Approximate number of contractions that the running mean remembers.
const MEMORY: f32 = 64.0;

/// Squared distance, in the frame, that always counts as usual: rounding errors and invisible
/// changes. On small models the mean must not have to grow from nothing. Geometric means as for
/// [`TOO_FAR`], relative to 1e-5: 1e-8 1.03, 1.00 (with a limit of 5); 1e-6 1.02, 1.04; 1e-4 1.01,
/// 1.04.
const NEGLIGIBLE: f32 = 1e-5;

/// Minimum delay in buckets: one octave.
const MIN_DELAY: u16 = 4;

/// Largest rise of the front after most of the surface could go no further, in buckets.
const LAST_RISE: u16 = 16;

/// Part of the faces that may go before it is counted again what can go no further.
const RECOUNT: usize = 64;

/// Usual squared distance at the front, in the frame's units.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Deferral {
    usual: f32,
    /// Highest front so far. Edges that are retried come before it.
    front: u16,
    /// Highest front of a contraction that was made.
    paid: u16,
    /// Value of `paid` when most of the surface was first found to go no further.
    stuck: Option<u16>,
    /// Number of faces when that was last looked at; 0 before.
    looked_at: usize,
}

impl Deferral {
    /// Returns the bucket to defer a contraction to, or `None` if it may go ahead. `now` is the
    /// squared distance of this step alone, `moved` includes all earlier ones.
    ///
    /// A deferred contraction counts for the mean too, or the mean would stay behind the front.
    #[inline(always)]
    pub(crate) fn wait(&mut self, now: f32, moved: f32, front: u16) -> Option<u16> {
        self.usual += (now.min(TOO_FAR * self.usual()) - self.usual) / MEMORY;
        self.front = self.front.max(front);
        self.delay(moved, self.front)
    }

    /// Returns the usual squared distance.
    #[inline(always)]
    fn usual(&self) -> f32 {
        self.usual.max(NEGLIGIBLE)
    }

    /// Returns the mean square distance that preserving the volume may add to a step.
    #[inline(always)]
    pub(crate) fn allowed(&self) -> f64 {
        VOLUME_SHARE * f64::from(self.usual())
    }

    /// Returns the bucket to defer a step to that has this bucket and moves the surface by this
    /// squared distance, or `None` if it may go ahead.
    #[inline(always)]
    pub(crate) fn delay(&self, moved: f32, bucket: u16) -> Option<u16> {
        let excess = moved / (TOO_FAR * self.usual());
        if excess > 1.0 { later(self.front.max(bucket), excess) } else { None }
    }

    /// Notes that a contraction has been made at a front.
    #[inline(always)]
    pub(crate) fn pay(&mut self, front: u16) {
        self.paid = self.paid.max(front);
    }

    /// Returns true if most of the surface can go no further, as `is_stuck` finds out, and what can
    /// costs so much more since that it would pay for all of it.
    #[cold]
    pub(crate) fn is_beyond_price(
        &mut self,
        (front, faces): (u16, usize),
        is_stuck: impl FnOnce() -> bool,
    ) -> bool {
        if self.looked_at == 0 || faces + self.looked_at / RECOUNT < self.looked_at {
            self.looked_at = faces;
            self.stuck = is_stuck().then(|| self.stuck.unwrap_or(self.paid));
        }
        self.stuck.is_some_and(|stuck| front > stuck.saturating_add(LAST_RISE))
    }

    /// Continues from the farther of two states.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.usual = self.usual.max(other.usual);
        self.front = self.front.max(other.front);
        self.paid = self.paid.max(other.paid);
        // The whole is looked at anew.
        (self.stuck, self.looked_at) = (None, 0);
    }
}

/// Returns the bucket of costs `times` as high as at the front; `None` if it is beyond the last.
#[cold]
fn later(front: u16, times: f32) -> Option<u16> {
    let to = bucket(min_cost_in(front).max(f32::MIN_POSITIVE) * times).max(front + MIN_DELAY);
    (to < last_bucket()).then_some(to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contractions_that_go_much_farther_are_deferred() {
        let (mut deferral, front) = (Deferral::default(), bucket(1.0));
        for _ in 0..1000 {
            deferral.wait(0.01, 0.01, front);
        }
        assert_eq!(deferral.wait(0.01, 0.035, front), None);
        let waits =
            |deferral: &mut Deferral, moved| deferral.wait(moved, moved, front).unwrap() - front;
        assert_eq!(waits(&mut deferral, 0.08), MIN_DELAY);
        assert!(waits(&mut deferral, 10.0) > 20);
        assert_eq!(deferral.wait(0.01, 0.01, front), None);
        // Just as far behind the front, wherever it is tried again.
        assert!(deferral.wait(10.0, 10.0, 0).unwrap() > front + 16);
        let mut joined = Deferral::default();
        joined.merge(&deferral);
        assert_eq!(joined.wait(0.01, 0.035, 0), None);
    }

    #[test]
    fn deferral_ends() {
        let mut deferral = Deferral::default();
        let mut front = 0;
        for _ in 0..u16::MAX {
            match deferral.wait(1.0, f32::INFINITY, front) {
                Some(to) => front = to,
                None => return,
            }
        }
        panic!("deferred for ever");
    }

    #[test]
    fn rounding_on_flats_is_not_deferred() {
        let mut deferral = Deferral::default();
        assert_eq!(deferral.wait(1e-14, 1e-12, 0), None);
    }
}
