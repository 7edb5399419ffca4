//! One grid for all parts: the size of its cells, and what is in them.

use meshlod_mesh::Bounds;

use super::Part;
use super::surface::Surface;

/// Where in a cell a vertex is decoded to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cells {
    /// The middle: half the error of the other.
    #[default]
    Centred,
    /// The least corner, as in [LCL10]: every vertex is half a cell too low.
    Truncated,
}

/// Cells of one size from the origin on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    cell: [f32; 3],
    cells: Cells,
}

/// The cells of a part along an axis, from its first to its last.
const ACROSS: f64 = 255.0;
/// No cell is smaller than this part of how far from the origin the mesh goes: `f32` tells the middles of
/// cells apart so far, and no further.
const FINEST: f64 = 1.0 / (1 << 22) as f64;

impl Grid {
    /// The finest in which each of these boxes has at most 256 cells along each axis.
    pub(super) fn new(boxes: &[Bounds], cells: Cells) -> Self {
        let cell = [0, 1, 2].map(|axis| {
            let spans = boxes.iter().map(|of| [of.min[axis], of.max[axis]]);
            let longest = spans.clone().map(|[min, max]| max - min).fold(0.0, f64::max);
            let farthest = spans.clone().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
            let fits = |cell: f32| {
                let across = |[min, max]: [f64; 2]| number(max, cell) - number(min, cell);
                spans.clone().all(|span| across(span) <= ACROSS)
            };
            let least = f64::from(f32::MIN_POSITIVE);
            let mut cell = (longest / ACROSS).max(farthest * FINEST).max(least) as f32;
            // Two roundings may have made it too small by a little.
            while !fits(cell) {
                cell = cell.next_up();
            }
            cell
        });
        Self { cell, cells }
    }

    pub(super) fn cell(&self) -> [f32; 3] {
        self.cell
    }

    /// Fills in the offset of a part, and the cells of its vertices from there on.
    pub(super) fn quantize(&self, surface: &Surface, part: &mut Part) {
        let cells = |&vertex| {
            let place = surface.position(vertex);
            [0, 1, 2].map(|axis| number(place[axis], self.cell[axis]) as i32)
        };
        let cells: Vec<[i32; 3]> = part.vertices.iter().map(cells).collect();
        part.offset = [0, 1, 2].map(|axis| cells.iter().map(|of| of[axis]).min().unwrap_or(0));
        let from_offset = |of: &[i32; 3]| [0, 1, 2].map(|k| (of[k] - part.offset[k]) as u8);
        part.positions = cells.iter().map(from_offset).collect();
    }

    /// Where a cell of a part is decoded to: the same place for whatever part it is told by.
    pub(super) fn place(&self, part: &Part, position: [u8; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let cell = part.offset[axis] + i32::from(position[axis]);
            (f64::from(cell) + self.within()) * f64::from(self.cell[axis])
        })
    }

    /// What a GPU multiplies the positions of a part with.
    pub(super) fn matrix(&self, part: &Part) -> [[f32; 4]; 3] {
        [0, 1, 2].map(|axis| {
            let mut row = [0.0; 4];
            row[axis] = self.cell[axis];
            row[3] = self.cell[axis] * (part.offset[axis] as f32 + self.within() as f32);
            row
        })
    }

    fn within(&self) -> f64 {
        match self.cells {
            Cells::Centred => 0.5,
            Cells::Truncated => 0.0,
        }
    }
}

/// The number of the cell that a place along an axis is in.
fn number(x: f64, cell: f32) -> f64 {
    (x / f64::from(cell)).floor()
}
