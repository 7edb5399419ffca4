//! A right-triangulated irregular network (RTIN) over a height field: the regular MT [EKT01].
//!
//! An update inserts one vertex of the grid in the middle of a hypotenuse and so bisects the one or
//! two triangles that share it. It depends on the vertices at their right angles. All of that is
//! arithmetic; stored are only a height, an error and two radii, ten bytes per vertex.

mod budget;
mod build;
mod bytes;
mod certificate;
mod cut;
mod extract;
mod field;
mod grid;
mod recognize;

#[cfg(test)]
mod tests;

use glam::Vec3;
use meshlod_mesh::{Bounds, Frame};

use crate::length16::Length16;
use crate::level::Level;
use crate::query::Ball;
use crate::query::{Query, QueryError, closest_point};

use self::field::GridPlacement;
use self::grid::{Grid, GridPoint};

pub use self::bytes::{FieldBytesError, HeightPrecision};
pub use self::certificate::{RtinCertifyError, RtinFlaw};
pub use self::cut::RtinCut;
pub use self::extract::RtinExtractor;
pub use self::field::{Fit, HeightField};
pub use self::recognize::HeightFieldError;

/// All levels of detail of a height field, as a right-triangulated irregular network.
///
/// The nodes of its levels are vertices of the grid, row by row. Each level covers the rectangle of
/// the field exactly. If that is not a square of 2ᵏ cells, triangles along its far sides are small
/// in every level.
///
/// Errors are **bounds** of the distance along the axis between a triangle and the finest level. A
/// triangle is a union of finest ones, over each of which both are linear, so the distance is
/// greatest at a vertex, and there it was measured. [`Rtin::fit`] bounds the distance from the
/// finest level to the mesh.
#[derive(Clone, Debug)]
pub struct Rtin {
    frame: Frame,
    grid: Grid,
    /// Placement of the grid in stored units.
    placement: GridPlacement,
    vertices: Vec<GridVertex>,
    /// Radius of a ball about each vertex that holds just the triangles its insertion removes.
    radii: Vec<Length16>,
    fit: Fit,
}

/// Stored data of a vertex.
#[derive(Clone, Copy, Debug, Default)]
struct GridVertex {
    height: f32,
    /// Error of the triangles that its insertion removes, at least that of every vertex depending
    /// on it. Infinite if one of them lies across the border, as such vertices are in every level.
    error: Length16,
    /// Radius of a ball about it that holds the triangles its insertion removes and the balls of
    /// all vertices depending on it.
    radius: Length16,
}

impl GridVertex {
    /// Returns true if the vertex is in every level.
    #[inline]
    fn is_forced(&self) -> bool {
        self.error == Length16::INFINITE
    }
}

impl Rtin {
    /// Returns the smallest mesh that satisfies the query.
    ///
    /// Cost: allocates tables as long as the field; for several levels use an [`RtinExtractor`],
    /// which keeps them.
    /// # Errors
    /// The query is invalid.
    pub fn level(&self, query: &Query<'_>) -> Result<Level, QueryError> {
        RtinExtractor::new(self).exact(query).cloned()
    }

    /// Returns the point of the finest mesh that is closest to a point in model units.
    ///
    /// Cost: that of a query for a ball of up to four times the distance.
    /// # Errors
    /// A coordinate is not finite.
    pub fn closest_point(&self, point: [f64; 3]) -> Result<Option<[f64; 3]>, QueryError> {
        let mut extractor = RtinExtractor::new(self);
        closest_point(point, &self.bounds(), |query| extractor.exact(query).cloned())
    }

    /// Returns the bounding box of the finest mesh, in model units.
    fn bounds(&self) -> Bounds {
        let heights = || self.vertices.iter().map(|vertex| f64::from(vertex.height));
        let (low, high) =
            (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
        let last = GridPoint { column: self.grid.columns - 1, row: self.grid.rows - 1 };
        let ends = [(GridPoint::default(), low), (last, high)];
        Bounds::of(
            &ends.map(|(place, height)| self.frame.model(self.placement.point(place, height))),
        )
    }

    /// Returns the number of grid columns and of grid rows.
    pub fn size(&self) -> [u32; 2] {
        [self.grid.columns, self.grid.rows]
    }

    /// Returns the number of faces of the finest mesh.
    pub fn full_faces(&self) -> usize {
        2 * (self.grid.columns as usize - 1) * (self.grid.rows as usize - 1)
    }

    /// Returns the frame that converts between stored units and model units.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Returns bounds on the difference between the finest mesh and the mesh the height field was
    /// made from.
    pub fn fit(&self) -> Fit {
        self.fit
    }

    /// Returns the memory used by the model's vectors, in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.vertices[..]) + size_of_val(&self.radii[..])
    }

    /// Returns the position of a vertex, given as the number of its node, in model units.
    ///
    /// # Panics
    /// `node` is not below the product of [`Rtin::size`].
    pub fn position(&self, node: u32) -> [f64; 3] {
        self.frame.model(Vec3::from(self.stored_position(node)))
    }

    /// Returns the position of a vertex in stored units, as levels have it.
    fn stored_position(&self, node: u32) -> [f32; 3] {
        let (place, vertex) = (self.grid.place(node as usize), &self.vertices[node as usize]);
        self.placement.point(place, vertex.height.into()).as_vec3().into()
    }

    /// Returns the corners of a triangle counter-clockwise seen from outside, given as seen from
    /// the side of greater heights.
    #[inline]
    fn turned(&self, [apex, first, last]: [u32; 3]) -> [u32; 3] {
        if self.placement.looks_down { [apex, last, first] } else { [apex, first, last] }
    }

    /// Returns the ball of a vertex that holds the triangles it removes and the balls of its
    /// dependents.
    #[inline]
    fn nested_ball(&self, place: GridPoint) -> Ball {
        let vertex = &self.vertices[self.grid.index(place)];
        self.ball(place, vertex, vertex.radius)
    }

    /// Returns the ball of a vertex that holds just the triangles it removes.
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
