//! How far contractions take the surface at the front, and which take it much farther.
//!
//! The queue is in the order of swept volumes, squared. In their terms the tip of a spike is next to
//! nothing, however long it is. Whoever goes much farther than is usual by now waits until it is not
//! much any more. So the order changes, and no target is missed.

use crate::kernel::schedule::bucket_queue::{bucket, last_bucket, min_cost_in};

/// How many times the square of the usual way is too far. Greatest distances of igea and armadillo-173k
/// at 10 % and 1 %, mean of the latter: 6 .075, .365, .157, .80, .0795; 8 .074, .433, .180, 1.11, .0780;
/// none .102, .372, .166, 2.14, .0792. More than 8 is worse: igea at 10 % .071 at 12, .101 at 20.
const FAR: f32 = 6.0;

/// How many contractions the mean of the usual way remembers, about.
const MEMORY: f32 = 64.0;

/// The square of a way that is none, in the frame: all ways are rounding where a surface is flat.
const NEGLIGIBLE: f32 = 1e-8;

/// How many buckets further back one waits at least: an octave.
const MIN_DELAY: u16 = 4;

/// The usual way at the front, squared, in the frame's units.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Deferral {
    usual: f32,
    /// The farthest that the front has been: what is tried anew comes before it.
    front: u16,
}

impl Deferral {
    /// The bucket to wait for with a contraction that takes the surface so far, `now` by itself and
    /// `moved` with all that was before; `None` if it may go.
    ///
    /// One that has to wait counts too: the usual way would stay behind the front.
    #[inline(always)]
    pub(crate) fn wait(&mut self, now: f32, moved: f32, front: u16) -> Option<u16> {
        let limit = FAR * self.usual.max(NEGLIGIBLE);
        self.usual += (now.min(limit) - self.usual) / MEMORY;
        self.front = self.front.max(front);
        let excess = moved / (FAR * self.usual.max(NEGLIGIBLE));
        if excess > 1.0 { later(self.front, excess) } else { None }
    }

    /// Goes on where the farther one of two has been.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.usual = self.usual.max(other.usual);
        self.front = self.front.max(other.front);
    }
}

/// Where the front is when costs are so many times as high; `None` if it never is.
#[cold]
fn later(front: u16, times: f32) -> Option<u16> {
    let to = bucket(min_cost_in(front).max(f32::MIN_POSITIVE) * times).max(front + MIN_DELAY);
    (to < last_bucket()).then_some(to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_goes_much_farther_than_others_waits() {
        let (mut deferral, front) = (Deferral::default(), bucket(1.0));
        for _ in 0..1000 {
            deferral.wait(0.01, 0.01, front);
        }
        assert_eq!(deferral.wait(0.01, 0.05, front), None);
        let waits =
            |deferral: &mut Deferral, moved| deferral.wait(moved, moved, front).unwrap() - front;
        assert_eq!(waits(&mut deferral, 0.1), MIN_DELAY);
        assert!(waits(&mut deferral, 10.0) > 20);
        assert_eq!(deferral.wait(0.01, 0.01, front), None);
        // As far behind the front, from wherever it is tried anew.
        assert!(deferral.wait(10.0, 10.0, 0).unwrap() > front + 16);
        let mut joined = Deferral::default();
        joined.merge(&deferral);
        assert_eq!(joined.wait(0.01, 0.05, 0), None);
    }

    #[test]
    fn waiting_ends() {
        let mut deferral = Deferral::default();
        let mut front = 0;
        for _ in 0..u16::MAX {
            match deferral.wait(1.0, f32::INFINITY, front) {
                Some(to) => front = to,
                None => return,
            }
        }
        panic!("it waits for ever");
    }

    #[test]
    fn flats_do_not_wait_for_their_rounding() {
        let mut deferral = Deferral::default();
        assert_eq!(deferral.wait(1e-14, 1e-12, 0), None);
    }
}
