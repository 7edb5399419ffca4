//! Verification of all that a hierarchy stores.

use thiserror::Error;

use super::Rtin;
use super::grid::GridPoint;
use crate::length16::Length16;
use crate::query::Ball;

/// Reasons why a hierarchy cannot be certified.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the vertex at column {column}, row {row} is not sound: {why}")]
pub struct RtinCertifyError {
    /// Column of the vertex.
    pub column: u32,
    /// Row of the vertex.
    pub row: u32,
    /// The flaw.
    pub why: RtinFlaw,
}

/// Flaws of a vertex.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq, PartialOrd, Ord)]
pub enum RtinFlaw {
    /// A level without it would extend beyond the border.
    #[error("it removes triangles across the border but is not in every level")]
    NotForced,
    /// A triangle deviates by more than the error.
    #[error("its error is less than the deviation of the triangles it removes")]
    NoBound,
    /// A query might miss it.
    #[error("its ball does not contain the triangles it removes")]
    SmallBall,
    /// A level might contain it without its dependencies.
    #[error("its dependencies have smaller errors or balls")]
    NotNested,
}

impl Rtin {
    /// Proves that errors are bounds, that errors and balls nest along dependencies, and that
    /// triangles across the border are split in every level; returns the number of insertions.
    ///
    /// No level can have a crack, whatever is stored: both sides of an insertion have the boundary
    /// of one diamond.
    ///
    /// Cost: O(n log n).
    /// # Errors
    /// The first vertex that fails.
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
