//! Balls that nest along every dependency: what they want is a cut as it stands, without forcing.
//!
//! Balls and errors that nest for themselves would be far too large: whoever needs many others would
//! have to be as large as all of them and as wrong as the worst. For one camera and one tolerance only
//! the sum counts, the *reach*: from how far away the update is still wanted, `radius + error / slope`.
//! It is made to nest at both ends of a range of slopes; a straight line between them in `1 / slope` is
//! a radius and an error again, and since it nests at its ends it nests between.

use glam::{DVec3, Vec3};

use super::{Implicit, Order};
use crate::forest::{Forest, NONE};
use crate::need::{Ball, Need};
use crate::query::QueryError;

/// A radius and an error an update, 8 bytes; for tolerances of the range it was made for.
#[derive(Clone, Debug)]
pub struct Saturated {
    /// The tolerances a unit of distance between which the balls nest.
    slopes: [f64; 2],
    balls: Vec<[f32; 2]>,
}

impl Saturated {
    /// Nests the balls for tolerances a unit of distance between these: `most` pixels are
    /// `most * camera.pixel()`. A range of four is good; wider ones make larger cuts.
    ///
    /// Cost: linear.
    /// # Errors
    /// A range that is none.
    pub fn new(forest: &Forest, slopes: [f64; 2]) -> Result<Self, QueryError> {
        let order = Order::new(forest);
        Self::in_order(forest, &order, slopes)
    }

    pub(crate) fn in_order(
        forest: &Forest,
        order: &Order,
        slopes: [f64; 2],
    ) -> Result<Self, QueryError> {
        let is_range = slopes[0] > 0.0 && slopes[0] <= slopes[1] && slopes[1].is_finite();
        if !is_range {
            return Err(QueryError::BadLength { what: "a range of tolerances", value: slopes[0] });
        }
        let mut balls = vec![[0.0; 2]; forest.updates.len()];
        for (u, ball) in nested(forest, slopes).into_iter().enumerate() {
            balls[order.place_of_update[u] as usize] = ball;
        }
        Ok(Self { slopes, balls })
    }

    /// What it takes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.balls[..])
    }

    /// Whether the balls nest for a need: one of a camera that looks at everything, within the range.
    pub(crate) fn serves(&self, need: &Need<'_>) -> bool {
        let [least, most] = self.slopes;
        let range = least * (1.0 - 1e-9)..=most * (1.0 + 1e-9);
        need.eye().is_some_and(|eye| range.contains(&eye.slope))
    }

    /// The ball of an update.
    #[inline]
    pub(crate) fn ball(&self, mt: &Implicit, update: u32, node: u32) -> Ball {
        let [radius, error] = self.balls[update as usize].map(f64::from);
        let center = Vec3::from(mt.positions()[node as usize]).as_dvec3();
        Ball { center, radius, error }
    }
}

/// The balls of the forest's updates, in its order: each reaches, at both slopes, as far as those that
/// need it do.
fn nested(forest: &Forest, slopes: [f64; 2]) -> Vec<[f32; 2]> {
    let parents = forest.parents();
    let mut reaches: Vec<[f64; 2]> = (0..forest.updates.len())
        .map(|u| {
            let ball = forest.ball(u);
            slopes.map(|slope| ball.radius + ball.error / slope)
        })
        .collect();
    let mut balls = Vec::with_capacity(reaches.len());
    for u in 0..forest.updates.len() {
        let ball = chord(slopes, reaches[u], forest.ball(u).error);
        let [radius, error] = ball.map(f64::from);
        let center = place(forest, u);
        let own = std::iter::once(forest.node(u) as u32);
        for node in forest.ring(u).iter().copied().chain(own) {
            let needed = parents[node as usize];
            if needed != NONE {
                let apart = center.distance(place(forest, needed as usize));
                for (reach, slope) in reaches[needed as usize].iter_mut().zip(slopes) {
                    *reach = reach.max((apart + radius + error / slope) * (1.0 + 1e-7));
                }
            }
        }
        if forest.updates[u].glued {
            balls[u - 1] = ball;
        }
        balls.push(ball);
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

fn place(forest: &Forest, update: usize) -> DVec3 {
    Vec3::from(forest.positions[forest.node(update)]).as_dvec3()
}
