//! Cells of the octree by depth and place.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::lattice::{BITS, Point};

/// Depth at which cells are so small that they are not divided further: eight vertices a side.
pub const MOST_DEPTH: u8 = 18;

/// Bits of a coordinate along the side of a cell in the content of a tile. A bit more is for skirts.
const GRID_BITS: u32 = 15;

/// Cell of the octree over the lattice; the root has depth 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub struct Cell {
    /// Number of divisions from the root.
    pub depth: u8,
    /// Number of cells of this depth before it, on each axis.
    pub at: [u32; 3],
}

/// Returns the number of steps between points of the grid that contents of a depth are on, a power
/// of two.
pub(crate) fn grid_step(depth: u8) -> i32 {
    1 << (BITS - u32::from(depth)).saturating_sub(GRID_BITS)
}

impl Cell {
    /// Whole lattice.
    pub const ROOT: Self = Self { depth: 0, at: [0; 3] };

    /// Returns false for what is not a cell of the lattice, as read from a file.
    pub fn is_sound(self) -> bool {
        self.depth <= MOST_DEPTH && self.at.iter().all(|at| at >> self.depth == 0)
    }

    /// Returns one of the eight cells that this one is divided into: bit `axis` of `octant` is 1 on
    /// the far side.
    pub fn child(self, octant: usize) -> Self {
        let at = [0, 1, 2].map(|axis| 2 * self.at[axis] + (octant as u32 >> axis & 1));
        Self { depth: self.depth + 1, at }
    }

    /// Returns the number of steps along a side.
    pub fn width(self) -> i32 {
        1 << (BITS - u32::from(self.depth))
    }

    /// Returns the corner with the least coordinates.
    pub fn low(self) -> Point {
        self.at.map(|at| at as i32 * self.width())
    }

    /// Returns the corner with the greatest coordinates.
    pub fn high(self) -> Point {
        self.low().map(|low| low + self.width())
    }

    /// Returns the planes at which the cell is divided, one an axis.
    pub fn middle(self) -> Point {
        self.low().map(|low| low + self.width() / 2)
    }

    /// Returns the sides of the cell that a point is on, bit `2 axis` for the near and
    /// `2 axis + 1` for the far one.
    pub fn sides_of(self, point: Point) -> u8 {
        let (low, high) = (self.low(), self.high());
        (0..3).fold(0, |sides, axis| {
            let near = u8::from(point[axis] == low[axis]);
            let far = u8::from(point[axis] == high[axis]);
            sides | near << (2 * axis) | far << (2 * axis + 1)
        })
    }

    /// Returns true if a point is inside or on a side.
    pub fn contains(self, point: Point) -> bool {
        let (low, high) = (self.low(), self.high());
        (0..3).all(|axis| (low[axis]..=high[axis]).contains(&point[axis]))
    }
}

/// Writes depth and place as in names of files: `3-1-7-0`.
impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.at;
        write!(f, "{}-{x}-{y}-{z}", self.depth)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::END;

    #[test]
    fn children_share_the_planes_in_the_middle() {
        assert_eq!((Cell::ROOT.low(), Cell::ROOT.high()), ([0; 3], [END; 3]));
        let cell = Cell::ROOT.child(5).child(2);
        assert_eq!((cell.to_string(), cell.low()[0] * 2), ("2-2-1-2".to_owned(), END));
        for octant in 0..8 {
            let child = cell.child(octant);
            let shared = [0, 1, 2].map(|axis| match octant >> axis & 1 {
                0 => child.high()[axis],
                _ => child.low()[axis],
            });
            assert_eq!(shared, cell.middle());
            assert!(cell.contains(child.low()) && cell.contains(child.high()));
        }
    }

    #[test]
    fn a_point_knows_its_sides() {
        let cell = Cell::ROOT.child(1);
        let (low, high) = (cell.low(), cell.high());
        assert_eq!(cell.sides_of([low[0], 1, high[2]]), 0b10_00_01);
        assert_eq!(cell.sides_of(cell.middle()), 0);
    }
}
