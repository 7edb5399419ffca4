//! The grid that all parts share.

use meshlod_mesh::Bounds;

use super::Part;
use super::face_graph::FaceGraph;

/// Point of a grid cell to which the vertices in it are decoded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Reconstruction {
    /// The middle of the cell, which halves the largest error.
    #[default]
    Centred,
    /// The corner of the cell with the least coordinates, as in [LCL10]: on average, every vertex
    /// is half a cell too low.
    Truncated,
}

/// Grid of equal cells from the origin on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SharedGrid {
    cell: [f32; 3],
    cells: Reconstruction,
}

/// Cells of a part along an axis, from the first to the last.
pub(super) const ACROSS: f64 = 255.0;
/// Minimum side of a cell, relative to the mesh's largest absolute coordinate: `f32` cannot tell
/// the middles of smaller cells apart.
const FINEST: f64 = 1.0 / (1 << 22) as f64;
/// Largest offset of a part: twice what [`FINEST`] allows, to leave room for rounding.
pub(super) const MAX_OFFSET: u32 = 1 << 23;

impl SharedGrid {
    /// Finds the finest grid in which each of the boxes spans at most 256 cells along each axis.
    ///
    /// With vertices in the middles of cells, sides have so few significant bits that `f32` decodes
    /// parts exactly: borders match those of the neighbours bit for bit.
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
            // Rounding may have made it slightly too small.
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

    pub(super) fn mean_side(&self) -> f64 {
        self.cell.iter().map(|&side| f64::from(side)).sum::<f64>() / 3.0
    }

    /// Returns the cell that contains a point.
    pub(super) fn number(&self, place: [f64; 3]) -> [i32; 3] {
        [0, 1, 2].map(|axis| number(place[axis], self.cell[axis]) as i32)
    }

    /// Sets the offset of a part, and the local cells of its vertices.
    pub(super) fn quantize(&self, graph: &FaceGraph, part: &mut Part) {
        let cells = part.vertices.iter().map(|&vertex| self.number(graph.position(vertex)));
        let cells: Vec<[i32; 3]> = cells.collect();
        part.offset = [0, 1, 2].map(|axis| cells.iter().map(|of| of[axis]).min().unwrap_or(0));
        let from_offset = |of: &[i32; 3]| [0, 1, 2].map(|k| (of[k] - part.offset[k]) as u8);
        part.positions = cells.iter().map(from_offset).collect();
    }

    /// Restores a grid; `None` if a side is not a positive normal number.
    pub(super) fn of_cells(cell: [f32; 3], cells: Reconstruction) -> Option<Self> {
        cell.iter().all(|side| side.is_normal() && *side > 0.0).then_some(Self { cell, cells })
    }

    pub(super) fn is_centred(&self) -> bool {
        self.cells == Reconstruction::Centred
    }

    /// Returns where a cell of a part is decoded to, which is the same from every part.
    pub(super) fn place(&self, offset: [i32; 3], position: [u8; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let cell = offset[axis] + i32::from(position[axis]);
            (f64::from(cell) + self.within()) * f64::from(self.cell[axis])
        })
    }

    /// Returns the matrix that decodes the positions of a part on the GPU.
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

/// Returns how many trailing bits of a side must be zero for products with half cells to be exact.
fn spare_bits(cells: f64) -> u32 {
    // One bit for the halves, and room for the cells of the last part.
    let bits = (2.0 * cells + 2.0 * ACROSS).log2().ceil() as u32;
    bits.min(f32::MANTISSA_DIGITS - 1)
}

/// Rounds a side up so that its trailing bits are zero.
fn rounded_up(side: f32, spare: u32) -> f32 {
    let ones = (1u32 << spare) - 1;
    f32::from_bits((side.to_bits() + ones) & !ones)
}

/// Returns the index of the cell that contains a coordinate.
fn number(x: f64, cell: f32) -> f64 {
    (x / f64::from(cell)).floor()
}
