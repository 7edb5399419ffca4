//! Balls that nest along every dependency, so that the updates they require form a cut without any
//! forcing.
//!
//! Balls and errors that each nest by themselves would be far too large: an update with many
//! dependents would have to hold all of them and take the greatest of their errors. For one camera
//! and one tolerance only a sum counts, the *reach* `radius + error / slope`: the distance within
//! which the update is still required. The reach is made to nest at both ends of a range of slopes.
//! A straight line between them in `1 / slope` is again a radius and an error, and what nests at
//! both ends nests in between.

use glam::Vec3;

use super::{Dependencies, Implicit};
use crate::query::Ball;
use crate::query::QueryError;

/// Nested balls as one radius and one error per update, valid for a range of slopes.
#[derive(Clone, Debug)]
pub(crate) struct SaturatedBalls {
    /// Range of tolerances per unit of distance within which the balls nest.
    slopes: [f64; 2],
    balls: Vec<[f32; 2]>,
}

impl SaturatedBalls {
    /// Nests the balls along the dependencies.
    pub(crate) fn new(
        mt: &Implicit,
        dependencies: &Dependencies,
        slopes: [f64; 2],
    ) -> Result<Self, QueryError> {
        let is_range = slopes[0] > 0.0 && slopes[0] <= slopes[1] && slopes[1].is_finite();
        if !is_range {
            return Err(QueryError::BadRange(slopes[0], slopes[1]));
        }
        Ok(Self { slopes, balls: nested(mt, dependencies, slopes) })
    }

    /// Returns the memory used.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.balls[..])
    }

    /// Returns the factor by which a slope can still grow or shrink within the range; less than 1
    /// outside it.
    pub(crate) fn margin(&self, slope: f64) -> f64 {
        (slope / self.slopes[0]).min(self.slopes[1] / slope)
    }

    /// Returns the nested ball of an update.
    #[inline]
    pub(crate) fn ball(&self, mt: &Implicit, update: u32, node: u32) -> Ball {
        let [radius, error] = self.balls[update as usize].map(f64::from);
        let center = Vec3::from(mt.stored_position(node)).as_dvec3();
        Ball { center, radius, error }
    }
}

/// Computes balls whose reach, at both slopes, is at least that of every dependent.
fn nested(mt: &Implicit, dependencies: &Dependencies, slopes: [f64; 2]) -> Vec<[f32; 2]> {
    let reach = |ball: &Ball| slopes.map(|slope| ball.radius + ball.error / slope);
    let updates = 0..mt.update_count() as u32;
    let mut reaches: Vec<[f64; 2]> = updates.map(|update| reach(&mt.ball(update))).collect();
    let mut balls = vec![[0.0; 2]; reaches.len()];
    for update in dependencies.dependents_first() {
        let own = mt.ball(update);
        let [radius, error] = chord(slopes, reaches[update as usize], own.error);
        balls[update as usize] = [radius, error];
        let widened = reach(&Ball { radius: radius.into(), error: error.into(), ..own });
        for dependency in dependencies.of(update) {
            let apart = own.center.distance(mt.ball(dependency).center);
            for (reach, widened) in reaches[dependency as usize].iter_mut().zip(widened) {
                *reach = reach.max((apart + widened) * (1.0 + 1e-7));
            }
        }
    }
    balls
}

/// Returns a radius and an error with at least the given reach at both slopes. An inexact update
/// keeps an error, or it would never be required.
fn chord(slopes: [f64; 2], reaches: [f64; 2], least: f64) -> [f32; 2] {
    let [x0, x1] = slopes.map(|slope| 1.0 / slope);
    let error = if x0 > x1 { (reaches[0] - reaches[1]) / (x0 - x1) } else { 0.0 };
    let error = up(error.max(least));
    let radius = (0..2).map(|k| reaches[k] - f64::from(error) / slopes[k]).fold(0.0, f64::max);
    [up(radius), error]
}

/// Rounds up to single precision.
fn up(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) < x { rounded.next_up() } else { rounded }
}
