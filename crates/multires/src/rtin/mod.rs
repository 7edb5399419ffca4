//! A height field as a hierarchy of right triangles: the regular MT.
//!
//! An update inserts one vertex of the grid in the middle of a hypotenuse and so halves the one or two
//! triangles that share it. What it needs are the vertices at their right angles. All that is arithmetic;
//! stored is what no arithmetic knows: a height, an error and two radii, ten bytes a vertex.

mod budget;
mod build;
mod bytes;
mod certificate;
mod extract;
mod field;
mod grid;
mod recognize;

#[cfg(test)]
mod tests;

use crate::frame::{Frame, Length16};
use crate::level::Level;
use crate::query::Ball;
use crate::query::{Query, QueryError};

use self::field::GridPlacement;
use self::grid::{Grid, GridPoint};

pub use self::bytes::{FieldBytesError, HeightPrecision};
pub use self::certificate::{RtinCertifyError, RtinFlaw};
pub use self::extract::RtinExtractor;
pub use self::field::{Fit, HeightField};
pub use self::recognize::HeightFieldError;

/// All levels of a height field, from as few right triangles as its outline lets to all of them.
///
/// The nodes of its levels are vertices of the grid, row by row. Each level covers the rectangle of the
/// field exactly; where that is no square of 2ᵏ cells, triangles along its far sides are small in all.
///
/// Errors are **bounds** of the distance along the axis between a triangle and the finest level: a
/// triangle is a union of finest ones, over each of which both are linear, so that the distance is
/// greatest at a vertex, and there it was measured. [`Rtin::fit`] says how far the finest
/// level may be from the mesh.
#[derive(Clone, Debug)]
pub struct Rtin {
    frame: Frame,
    grid: Grid,
    /// In stored units.
    placement: GridPlacement,
    vertices: Vec<GridVertex>,
    /// Of a ball about each vertex, around the triangles that its insertion takes away and no more.
    radii: Vec<Length16>,
    fit: Fit,
}

/// What is stored of a vertex.
#[derive(Clone, Copy, Debug, Default)]
struct GridVertex {
    height: f32,
    /// Of the triangles that its insertion takes away, never less than that of a vertex that needs it.
    /// Infinite where one of them lies across the border of the field: such are in every level.
    error: Length16,
    /// Of a ball about it, around the triangles that its insertion takes away and the balls of the
    /// vertices that need it.
    radius: Length16,
}

impl GridVertex {
    /// It is there in every level.
    #[inline]
    fn is_forced(&self) -> bool {
        self.error == Length16::INFINITE
    }
}

impl Rtin {
    /// The smallest level that meets the query.
    ///
    /// Cost: what a [`RtinExtractor`] saves where several levels are asked for is a table as long as the
    /// field.
    /// # Errors
    /// A query that is none.
    pub fn level(&self, query: &Query<'_>) -> Result<Level, QueryError> {
        RtinExtractor::new(self).exact(query).cloned()
    }

    /// How many vertices in a row, and how many rows.
    pub fn size(&self) -> [u32; 2] {
        [self.grid.columns, self.grid.rows]
    }

    /// How many faces the finest level has.
    pub fn full_faces(&self) -> usize {
        2 * (self.grid.columns as usize - 1) * (self.grid.rows as usize - 1)
    }

    /// Where it is, and the unit of what is stored.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// How far the finest level may be from what it was made of.
    pub fn fit(&self) -> Fit {
        self.fit
    }

    /// What it takes in memory: its vectors, as they are.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.vertices[..]) + size_of_val(&self.radii[..])
    }

    /// About a vertex, around the triangles that it takes away and the balls of those that need it.
    #[inline]
    fn nested_ball(&self, place: GridPoint) -> Ball {
        let vertex = &self.vertices[self.grid.index(place)];
        self.ball(place, vertex, vertex.radius)
    }

    /// About a vertex, around the triangles that it takes away and no more.
    #[inline]
    fn own_ball(&self, place: GridPoint) -> Ball {
        let index = self.grid.index(place);
        self.ball(place, &self.vertices[index], self.radii[index])
    }

    #[inline]
    fn ball(&self, place: GridPoint, vertex: &GridVertex, radius: Length16) -> Ball {
        let center = self.placement.point(place, vertex.height.into());
        Ball { center, radius: radius.get(), error: vertex.error.get() }
    }
}
