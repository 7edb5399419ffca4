//! One grid for all parts: the size of its cells, and what is in them.

use meshlod_mesh::Bounds;

use super::Part;
use super::face_graph::FaceGraph;

/// Where in a cell a vertex is decoded to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reconstruction {
    /// The middle: half the error of the other.
    #[default]
    Centred,
    /// The least corner, as in [LCL10]: every vertex is half a cell too low.
    Truncated,
}

/// Cells of one size from the origin on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SharedGrid {
    cell: [f32; 3],
    cells: Reconstruction,
}

/// The cells of a part along an axis, from its first to its last.
const ACROSS: f64 = 255.0;
/// No cell is smaller than this part of how far from the origin the mesh goes: `f32` tells the middles of
/// cells apart so far, and no further.
const FINEST: f64 = 1.0 / (1 << 22) as f64;
/// So the cell of an offset is this many from the origin at most: twice what [`FINEST`] leaves, for what is rounded.
pub(super) const FARTHEST: u32 = 1 << 23;

impl SharedGrid {
    /// The finest in which each of these boxes has at most 256 cells along each axis.
    ///
    /// Where vertices are in the middles of cells, sides have no more significant bits than leave all that `f32`
    /// makes of a part exact: its borders are those of its neighbours, bit for bit.
    pub(super) fn new(boxes: &[Bounds], cells: Reconstruction) -> Self {
        let cell = [0, 1, 2].map(|axis| {
            let spans = boxes.iter().map(|of| [of.min[axis], of.max[axis]]);
            let longest = spans.clone().map(|[min, max]| max - min).fold(0.0, f64::max);
            let farthest = spans.clone().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
            let fits = |cell: f32| {
                let across = |[min, max]: [f64; 2]| number(max, cell) - number(min, cell);
                spans.clone().all(|span| across(span) <= ACROSS)
            };
            let least = f64::from(f32::MIN_POSITIVE);
            let cell = (longest / ACROSS).max(farthest * FINEST).max(least) as f32;
            let spare = match cells {
                Reconstruction::Centred => spare_bits(farthest / f64::from(cell)),
                Reconstruction::Truncated => 0,
            };
            let mut cell = rounded_up(cell, spare);
            // Roundings may have made it too small by a little.
            while !fits(cell) {
                cell = rounded_up(cell.next_up(), spare);
            }
            cell
        });
        Self { cell, cells }
    }

    pub(super) fn cell(&self) -> [f32; 3] {
        self.cell
    }

    /// Fills in the offset of a part, and the cells of its vertices from there on.
    pub(super) fn quantize(&self, graph: &FaceGraph, part: &mut Part) {
        let cells = |&vertex| {
            let place = graph.position(vertex);
            [0, 1, 2].map(|axis| number(place[axis], self.cell[axis]) as i32)
        };
        let cells: Vec<[i32; 3]> = part.vertices.iter().map(cells).collect();
        part.offset = [0, 1, 2].map(|axis| cells.iter().map(|of| of[axis]).min().unwrap_or(0));
        let from_offset = |of: &[i32; 3]| [0, 1, 2].map(|k| (of[k] - part.offset[k]) as u8);
        part.positions = cells.iter().map(from_offset).collect();
    }

    /// A grid that was made before, if its cells have a size.
    pub(super) fn of_cells(cell: [f32; 3], cells: Reconstruction) -> Option<Self> {
        cell.iter().all(|side| side.is_normal() && *side > 0.0).then_some(Self { cell, cells })
    }

    pub(super) fn is_centred(&self) -> bool {
        self.cells == Reconstruction::Centred
    }

    /// Where a cell of a part is decoded to: the same place for whatever part it is told by.
    pub(super) fn place(&self, offset: [i32; 3], position: [u8; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let cell = offset[axis] + i32::from(position[axis]);
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
            Reconstruction::Centred => 0.5,
            Reconstruction::Truncated => 0.0,
        }
    }
}

/// How many of the last bits of a side are to be zeros, for products with so many halves of cells to be exact.
fn spare_bits(cells: f64) -> u32 {
    // One more for the halves, one for the cells that a part goes on beyond.
    let bits = (2.0 * cells + 2.0 * ACROSS).log2().ceil() as u32;
    bits.min(f32::MANTISSA_DIGITS - 1)
}

/// The next number up, or the same, whose last bits are zeros.
fn rounded_up(side: f32, spare: u32) -> f32 {
    let ones = (1u32 << spare) - 1;
    f32::from_bits((side.to_bits() + ones) & !ones)
}

/// The number of the cell that a place along an axis is in.
fn number(x: f64, cell: f32) -> f64 {
    (x / f64::from(cell)).floor()
}
