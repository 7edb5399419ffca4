//! Balls that nest along every dependency: what they want is a cut as it stands, without forcing.
//!
//! Balls and errors that nest for themselves would be far too large: whoever needs many others would
//! have to be as large as all of them and as wrong as the worst. For one camera and one tolerance only
//! the sum counts, the *reach*: from how far away the update is still wanted, `radius + error / slope`.
//! It is made to nest at both ends of a range of slopes; a straight line between them in `1 / slope` is
//! a radius and an error again, and since it nests at its ends it nests between.

use glam::Vec3;

use super::{Dependencies, Implicit};
use crate::query::Ball;
use crate::query::QueryError;

/// A radius and an error an update, 8 bytes; for tolerances of the range it was made for.
#[derive(Clone, Debug)]
pub(crate) struct SaturatedBalls {
    /// The tolerances a unit of distance between which the balls nest.
    slopes: [f64; 2],
    balls: Vec<[f32; 2]>,
}

impl SaturatedBalls {
    /// Nests the balls along what updates need.
    pub(crate) fn new(
        mt: &Implicit,
        links: &Dependencies,
        slopes: [f64; 2],
    ) -> Result<Self, QueryError> {
        let is_range = slopes[0] > 0.0 && slopes[0] <= slopes[1] && slopes[1].is_finite();
        if !is_range {
            return Err(QueryError::BadLength { what: "a range of tolerances", value: slopes[0] });
        }
        Ok(Self { slopes, balls: nested(mt, links, slopes) })
    }

    /// What it takes in memory.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.balls[..])
    }

    /// How many times a tolerance a unit of distance may grow or shrink and still be in the range;
    /// less than once where it is not in it.
    pub(crate) fn inside(&self, slope: f64) -> f64 {
        (slope / self.slopes[0]).min(self.slopes[1] / slope)
    }

    /// The ball of an update.
    #[inline]
    pub(crate) fn ball(&self, mt: &Implicit, update: u32, node: u32) -> Ball {
        let [radius, error] = self.balls[update as usize].map(f64::from);
        let center = Vec3::from(mt.stored_position(node)).as_dvec3();
        Ball { center, radius, error }
    }
}

/// Balls that reach, at both slopes, as far as those that need them do.
fn nested(mt: &Implicit, links: &Dependencies, slopes: [f64; 2]) -> Vec<[f32; 2]> {
    let reach = |ball: &Ball| slopes.map(|slope| ball.radius + ball.error / slope);
    let updates = 0..mt.update_count() as u32;
    let mut reaches: Vec<[f64; 2]> = updates.map(|update| reach(&mt.ball(update))).collect();
    let mut balls = vec![[0.0; 2]; reaches.len()];
    for update in links.dependents_first() {
        let own = mt.ball(update);
        let [radius, error] = chord(slopes, reaches[update as usize], own.error);
        balls[update as usize] = [radius, error];
        let widened = reach(&Ball { radius: radius.into(), error: error.into(), ..own });
        for need in links.of(update) {
            let apart = own.center.distance(mt.ball(need).center);
            for (reach, widened) in reaches[need as usize].iter_mut().zip(widened) {
                *reach = reach.max((apart + widened) * (1.0 + 1e-7));
            }
        }
    }
    balls
}

/// The radius and the error that reach at least so far at both slopes. What has an error keeps one,
/// or it would never be wanted.
fn chord(slopes: [f64; 2], reaches: [f64; 2], least: f64) -> [f32; 2] {
    let [x0, x1] = slopes.map(|slope| 1.0 / slope);
    let error = if x0 > x1 { (reaches[0] - reaches[1]) / (x0 - x1) } else { 0.0 };
    let error = up(error.max(least));
    let radius = (0..2).map(|k| reaches[k] - f64::from(error) / slopes[k]).fold(0.0, f64::max);
    [up(radius), error]
}

/// Rounded up.
fn up(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) < x { rounded.next_up() } else { rounded }
}
