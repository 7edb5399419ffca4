//! Holds everything stored against what it promises.

use super::RightTriangles;
use super::places::Place;
use crate::cut::Unsound;
use crate::frame::Length16;
use crate::need::Ball;

impl RightTriangles {
    /// Proves that errors bound, that errors and balls nest along needs, and that what lies across the
    /// border is in every level; gives the number of insertions.
    ///
    /// That no level has a crack needs no looking: both sides of an insertion have the boundary of one
    /// diamond, whatever is stored.
    /// Cost: n log n.
    /// # Errors
    /// The first vertex of which that cannot be said.
    pub fn certify(&self) -> Result<usize, Unsound> {
        let mut sound = 0;
        for depth in 0..self.grid.depth() {
            for place in self.grid.inserted_at(depth) {
                let update = self.grid.index(place) as u32;
                self.check(place).map_err(|why| Unsound { update, why })?;
                sound += 1;
            }
        }
        Ok(sound)
    }

    fn check(&self, place: Place) -> Result<(), &'static str> {
        let error = self.vertices[self.grid.index(place)].error;
        match self.own_error(place) {
            Length16::INFINITE if error < Length16::INFINITE => {
                return Err("what it takes away lies across the border");
            }
            own if own > error => return Err("its error is no bound"),
            _ => {}
        }
        let ball = self.nested_ball(place);
        let own = self.own_ball(place).radius;
        if own < self.own_radius(place).get() || ball.radius < own {
            return Err("its ball is not around what it takes away");
        }
        let is_nested = |parent: Place| is_around(&self.nested_ball(parent), &ball);
        if !self.grid.parents(place).all(is_nested) {
            return Err("the ball or the error of what it needs is less than its own");
        }
        Ok(())
    }
}

fn is_around(outer: &Ball, inner: &Ball) -> bool {
    outer.error >= inner.error && outer.center.distance(inner.center) + inner.radius <= outer.radius
}
