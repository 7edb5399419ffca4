//! Heights over a regular grid.

use glam::DVec3;
use meshlod_mesh::Bounds;

use super::grid::{Grid, GridPoint};

/// Height field: heights over a regular grid in a plane perpendicular to a coordinate axis.
///
/// Its surface consists of right triangles that halve each cell, with diagonals alternating between
/// neighbours. A mesh that halves cells otherwise has the same vertices; [`Fit`] bounds the
/// difference.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    pub(super) grid: Grid,
    pub(super) placement: GridPlacement,
    /// Heights row by row, in model units.
    pub(super) heights: Vec<f64>,
    pub(super) fit: Fit,
}

/// Largest differences between a mesh and the height field made from it, in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Fit {
    /// Largest distance by which a vertex was moved onto the grid, within the grid's plane, in
    /// model units.
    pub moved: f64,
    /// Largest change of height where a grid cell was given its other diagonal, in model units.
    pub turned: f64,
    /// Largest error from rounding a height, in model units.
    pub rounded: f64,
}

/// Position and spacing of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GridPlacement {
    /// Axis of the heights: 0, 1 or 2. Columns advance along the next axis, rows along the one
    /// after.
    pub(super) up: u8,
    /// True if faces look towards lesser heights.
    pub(super) looks_down: bool,
    /// Coordinates of the first column and row.
    pub(super) origin: [f64; 2],
    /// Distances between columns and between rows, which are positive.
    pub(super) step: [f64; 2],
}

impl GridPlacement {
    /// Returns the axes of columns, rows and heights.
    #[inline]
    pub(super) fn axes(up: u8) -> [usize; 3] {
        let up = usize::from(up);
        [(up + 1) % 3, (up + 2) % 3, up]
    }

    #[inline]
    pub(super) fn point(&self, GridPoint { column, row }: GridPoint, height: f64) -> DVec3 {
        let [across, along, up] = Self::axes(self.up);
        let mut point = [0.0; 3];
        point[across] = self.origin[0] + f64::from(column) * self.step[0];
        point[along] = self.origin[1] + f64::from(row) * self.step[1];
        point[up] = height;
        point.into()
    }
}

impl HeightField {
    /// Returns the number of grid columns and of grid rows.
    pub fn size(&self) -> [u32; 2] {
        [self.grid.columns, self.grid.rows]
    }

    /// Returns the coordinate axis along which heights are measured: 0 for x, 1 for y, 2 for z.
    pub fn axis(&self) -> usize {
        self.placement.up.into()
    }

    /// Returns the heights row by row, in model units.
    ///
    /// Columns advance along the axis after that of the heights, rows along the one after.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Returns the surface point at a grid column and row, in model units.
    ///
    /// # Panics
    /// The point is outside the field.
    pub fn point(&self, column: u32, row: u32) -> [f64; 3] {
        let place = GridPoint { column, row };
        assert!(self.grid.holds(place), "column {column}, row {row} is outside the field");
        self.placement.point(place, self.heights[self.grid.index(place)]).into()
    }

    /// Returns bounds on the difference between the height field and the mesh it was made from.
    pub fn fit(&self) -> Fit {
        self.fit
    }

    /// Returns the bounding box of all points of the height field, in model units.
    pub fn bounds(&self) -> Bounds {
        let low = self.heights.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self.heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let last = GridPoint { column: self.grid.columns - 1, row: self.grid.rows - 1 };
        let ends =
            [self.placement.point(GridPoint::default(), low), self.placement.point(last, high)];
        Bounds::of(&ends.map(|end| end.to_array()))
    }
}
