//! Verification of all that an RTIN stores.

use thiserror::Error;

use super::Rtin;
use super::grid::GridPoint;
use crate::length16::Length16;
use crate::query::Ball;

/// Reason why an [`Rtin`] cannot be certified: a vertex with a flaw.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the vertex at column {column}, row {row} is not sound: {why}")]
pub struct RtinCertifyError {
    /// Grid column of the flawed vertex.
    pub column: u32,
    /// Grid row of the flawed vertex.
    pub row: u32,
    /// Flaw of the vertex.
    pub why: RtinFlaw,
}

/// Flaws that a vertex of an [`Rtin`] can have.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum RtinFlaw {
    /// A level without the vertex would extend beyond the border of the height field.
    #[error("it removes triangles across the border but is not in every level")]
    NotForced,
    /// A triangle that the vertex removes deviates by more than the vertex's stored error.
    #[error("its error is less than the deviation of the triangles it removes")]
    NoBound,
    /// The bounding ball of the vertex is too small, so that a query might miss the vertex.
    #[error("its ball does not contain the triangles it removes")]
    SmallBall,
    /// A level might contain the vertex without the vertices that it depends on.
    #[error("its dependencies have smaller errors or balls")]
    NotNested,
}

impl Rtin {
    /// Proves that every extracted level satisfies its query, and returns the number of vertices
    /// checked.
    ///
    /// Errors are bounds, errors and balls nest along dependencies, and triangles across the border
    /// are split in every level.
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
