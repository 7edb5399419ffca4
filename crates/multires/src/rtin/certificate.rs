//! Holds everything stored against what it promises.

use thiserror::Error;

use super::Rtin;
use super::grid::GridPoint;
use crate::frame::Length16;
use crate::query::Ball;

/// Why right triangles may be further off than their levels promise.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the vertex at column {column}, row {row} is not sound: {why}")]
pub struct RtinCertifyError {
    /// Its column.
    pub column: u32,
    /// Its row.
    pub row: u32,
    /// What does not hold.
    pub why: RtinFlaw,
}

/// What does not hold of a vertex.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq, PartialOrd, Ord)]
pub enum RtinFlaw {
    /// A level without it would go beyond the border.
    #[error("what it takes away lies across the border, and it is not in every level")]
    NotForced,
    /// A triangle is further off.
    #[error("its error is less than what it takes away is off by")]
    NoBound,
    /// It might not be looked for where it counts.
    #[error("its ball is not around what it takes away")]
    SmallBall,
    /// A level might have it without what it needs.
    #[error("the ball or the error of what it needs is less than its own")]
    NotNested,
}

impl Rtin {
    /// Proves that errors bound, that errors and balls nest along needs, and that what lies across the
    /// border is in every level; gives the number of insertions.
    ///
    /// That no level has a crack needs no looking: both sides of an insertion have the boundary of one
    /// diamond, whatever is stored.
    /// Cost: n log n.
    /// # Errors
    /// The first vertex of which that cannot be said.
    pub fn certify(&self) -> Result<usize, RtinCertifyError> {
        let mut sound = 0;
        for depth in 0..self.grid.depth() {
            for place in self.grid.inserted_at(depth) {
                let GridPoint { column, row } = place;
                self.check(place).map_err(|why| RtinCertifyError { column, row, why })?;
                sound += 1;
            }
        }
        Ok(sound)
    }

    fn check(&self, place: GridPoint) -> Result<(), RtinFlaw> {
        let error = self.vertices[self.grid.index(place)].error;
        match self.own_error(place) {
            Length16::INFINITE if error < Length16::INFINITE => return Err(RtinFlaw::NotForced),
            own if own > error => return Err(RtinFlaw::NoBound),
            _ => {}
        }
        let ball = self.nested_ball(place);
        let own = self.own_ball(place).radius;
        if own < self.own_radius(place).get() || ball.radius < own {
            return Err(RtinFlaw::SmallBall);
        }
        let is_nested = |parent: GridPoint| is_around(&self.nested_ball(parent), &ball);
        if !self.grid.parents(place).all(is_nested) {
            return Err(RtinFlaw::NotNested);
        }
        Ok(())
    }
}

fn is_around(outer: &Ball, inner: &Ball) -> bool {
    outer.error >= inner.error && outer.center.distance(inner.center) + inner.radius <= outer.radius
}
