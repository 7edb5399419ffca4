//! Heights over a lattice.

use glam::DVec3;
use meshlod_mesh::Bounds;

use super::grid::{Grid, GridPoint};

/// Heights over a regular lattice in a plane across one of the axes.
///
/// Its surface are the right triangles that halve each cell, the diagonals of neighbours across each
/// other. A mesh that halves them otherwise has the same vertices; [`Fit`] says by how much it differs.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    pub(super) grid: Grid,
    pub(super) placement: GridPlacement,
    /// Row by row, in model units along the axis.
    pub(super) heights: Vec<f64>,
    pub(super) fit: Fit,
}

/// How far a mesh may be from the height field that was made of it, in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fit {
    /// Most that a vertex was moved in the plane to its place on the lattice.
    pub moved: f64,
    /// Most that a cell was raised or lowered by having its other diagonal.
    pub turned: f64,
    /// Most that a height was rounded by.
    pub rounded: f64,
}

/// Where the places of the grid are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GridPlacement {
    /// The axis that heights are along: 0, 1 or 2. Columns go along the next one, rows along the one
    /// after that.
    pub(super) up: u8,
    /// Faces look towards lesser heights.
    pub(super) looks_down: bool,
    /// Of the first column and row.
    pub(super) origin: [f64; 2],
    /// From a column to the next, and from a row to the next; above 0.
    pub(super) step: [f64; 2],
}

impl GridPlacement {
    /// The axes of columns, rows and heights.
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
    /// How many vertices in a row, and how many rows.
    pub fn size(&self) -> [u32; 2] {
        [self.grid.columns, self.grid.rows]
    }

    /// The axis that heights are along: 0 for x, 1 for y, 2 for z.
    pub fn axis(&self) -> usize {
        self.placement.up.into()
    }

    /// In model units, row by row. Columns go along the axis after that of the heights, rows along
    /// the next one.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// The point of a column and a row, in model units.
    ///
    /// Panics outside the field.
    pub fn point(&self, column: u32, row: u32) -> [f64; 3] {
        let place = GridPoint { column, row };
        assert!(self.grid.holds(place), "column {column}, row {row} is outside the field");
        self.placement.point(place, self.heights[self.grid.index(place)]).into()
    }

    /// How far it may be from what it was made of.
    pub fn fit(&self) -> Fit {
        self.fit
    }

    /// The box around all points.
    pub fn bounds(&self) -> Bounds {
        let low = self.heights.iter().copied().fold(f64::INFINITY, f64::min);
        let high = self.heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let last = GridPoint { column: self.grid.columns - 1, row: self.grid.rows - 1 };
        let ends =
            [self.placement.point(GridPoint::default(), low), self.placement.point(last, high)];
        Bounds::of(&ends.map(|end| end.to_array()))
    }
}
