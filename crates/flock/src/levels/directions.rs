//! Grid of the directions from which a member is seen.
// Loops over lanes become vector code, closures over arrays need not; and `clamp` keeps a NaN.
#![allow(clippy::needless_range_loop, clippy::manual_clamp)]

use glam::{Vec2, Vec3};

use crate::cell_index::cell_index;

/// Directions in the frame of a member, sorted into the cells of an octahedral map.
///
/// The sphere is projected on an octahedron, which is unfolded to a square of `side` by `side`
/// cells [CDEMMM14].
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionGrid {
    side: usize,
    axes: Vec<Vec3>,
    half_angles_rad: Vec<f32>,
}

/// Largest number of cells along a side of the grid.
pub(crate) const MAX_SIDE: usize = 32;

impl DirectionGrid {
    /// Creates a grid of `side` by `side` cells, at least 2 and at most 32 a side.
    pub fn new(side: usize) -> Self {
        let side = side.clamp(2, MAX_SIDE);
        let place = |cell: usize, step: f32| (cell as f32 + step) / side as f32;
        let cells = (0..side * side).map(|i| [i % side, i / side]);
        let axes: Vec<Vec3> =
            cells.clone().map(|[x, y]| decode(place(x, 0.5), place(y, 0.5))).collect();
        // The farthest directions of a cell are on its rim.
        let rim = |[x, y]: [usize; 2]| {
            (0..=8).map(|i| i as f32 / 8.0).flat_map(move |t| {
                [[t, 0.0], [t, 1.0], [0.0, t], [1.0, t]]
                    .map(|[u, v]| decode(place(x, u), place(y, v)))
            })
        };
        let angle = |(cell, axis): ([usize; 2], &Vec3)| {
            rim(cell).map(|direction| direction.angle_between(*axis)).fold(0.0, f32::max)
        };
        let half_angles_rad = cells.zip(&axes).map(angle).collect();
        Self { side, axes, half_angles_rad }
    }

    /// Returns the number of cells.
    pub fn len(&self) -> usize {
        self.axes.len()
    }

    /// Returns false: a grid has cells.
    pub fn is_empty(&self) -> bool {
        self.axes.is_empty()
    }

    /// Returns true if every cell lies within a single cell of another grid.
    pub(crate) fn is_within(&self, other: &Self) -> bool {
        self.side.is_multiple_of(other.side)
    }

    /// Returns the direction in the middle of a cell, a unit vector.
    pub fn axis(&self, cell: usize) -> Vec3 {
        self.axes[cell]
    }

    /// Returns the greatest angle between a direction of a cell and the cell's axis, in radians.
    pub fn half_angle_rad(&self, cell: usize) -> f32 {
        self.half_angles_rad[cell]
    }

    /// Returns the cell of a direction, a vector of any length above zero.
    pub fn cell(&self, direction: Vec3) -> usize {
        let [x, y, z] = direction.to_array();
        let mut cells = [0];
        self.cells([&[x], &[y], &[z]], &mut cells);
        usize::from(cells[0])
    }

    /// Finds the cells of several directions, given by axis, without a branch.
    #[inline(always)]
    pub(crate) fn cells<const N: usize>(&self, [x, y, z]: [&[f32; N]; 3], cells: &mut [u16; N]) {
        let (half, last) = (0.5 * self.side as f32, self.side as f32 - 1.0);
        for i in 0..N {
            let scale = (x[i].abs() + y[i].abs() + z[i].abs()).recip();
            let (u, v) = (x[i] * scale, y[i] * scale);
            let below = z[i] < 0.0;
            let a = if below { (1.0 - v.abs()).copysign(u) } else { u };
            let b = if below { (1.0 - u.abs()).copysign(v) } else { v };
            let column = cell_index(a * half + half, last);
            let row = cell_index(b * half + half, last);
            cells[i] = (row * self.side as u32 + column) as u16;
        }
    }
}

/// Returns the unit vector at a point of the square [0, 1]².
fn decode(u: f32, v: f32) -> Vec3 {
    let p = Vec2::new(2.0 * u - 1.0, 2.0 * v - 1.0);
    let z = 1.0 - p.x.abs() - p.y.abs();
    let fold = |a: f32, b: f32| (1.0 - b.abs()).copysign(a);
    let (x, y) = if z < 0.0 { (fold(p.x, p.y), fold(p.y, p.x)) } else { (p.x, p.y) };
    Vec3::new(x, y, z).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_direction_is_near_the_axis_of_its_cell() {
        for side in [2, 5, 6, 8] {
            let grid = DirectionGrid::new(side);
            assert!((0..grid.len()).all(|cell| grid.cell(grid.axis(cell)) == cell));
            for i in 0..2_000 {
                let z = 1.0 - (i as f32 + 0.5) / 1_000.0;
                let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
                let flat = (1.0 - z * z).sqrt();
                let direction = Vec3::new(flat * cos, flat * sin, z);
                let angle = direction.angle_between(grid.axis(grid.cell(direction * 3.0)));
                assert!(
                    angle < grid.half_angle_rad(grid.cell(direction)) + 1e-3,
                    "{side}: {angle} at {direction}"
                );
            }
        }
    }

    #[test]
    fn a_direction_that_is_no_number_has_a_cell() {
        let grid = DirectionGrid::new(4);
        assert!(grid.cell(Vec3::ZERO) < grid.len() && grid.cell(Vec3::NAN) < grid.len());
    }
}
