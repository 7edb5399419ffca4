//! Vertex positions in blocks of 32, each block with a frame and cell sizes that follow the
//! surface.
//!
//! | files, in reading order | hold |
//! |---|---|
//! | `frame`, `layout`, `header`, `stored` | a block, and its bits |
//! | `fit`, `assign_cells`, `move_cost`, `refine` | the choice of cells |
//! | `original`, `deviation`, `reference`, `report` | what it costs |

mod assign_cells;
mod deviation;
mod fit;
mod frame;
mod header;
mod layout;
mod move_cost;
mod original;
mod reference;
mod refine;
mod report;
mod stored;
#[cfg(test)]
mod tests;

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};

use self::fit::FittedBlocks;
use self::header::{BlockHeader, numbers};
use self::layout::BlockLayout;
pub use self::report::{Accuracy, BlocksError, BlocksReport, SurfaceChange};
pub use self::stored::{StoredBlock, StoredBlocks};
use crate::bits::Bits;
use crate::bytes::{Malformed, Reader, reduction};
use crate::kd::{BLOCK, blocks_of};

/// Compressed positions of a mesh in blocks of 32 vertices, each with a matrix that decodes small
/// integers.
///
/// Each vertex is in one block, and faces may have corners in several, so nothing is stored twice
/// and no cracks can open between blocks. Any vertex can be decoded alone, to the same bits on
/// every machine.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexBlocks {
    layout: BlockLayout,
    /// Headers and cell numbers, group by group.
    bits: Bits,
    /// The mesh vertex that each stored vertex is; empty after decoding.
    vertices: Vec<VertexId>,
}

impl VertexBlocks {
    /// Encodes the vertices that faces use to a given accuracy, in as few bits as the search finds,
    /// and reports the error.
    ///
    /// Besides the mean error, no vertex should be farther from the other surface than about twice
    /// the largest distance in equally accurate cubic cells, and no more faces should be flipped.
    /// Blocks that fail are refined a few times; the report has what remains.
    ///
    /// Cost: O(n log n), with a few dozen visits of each face.
    /// # Errors
    /// A coordinate that is not finite, or a target that is invalid or too fine.
    pub fn new(mesh: &Mesh, target: Accuracy) -> Result<(Self, BlocksReport), BlocksError> {
        let ordered = blocks_of(mesh);
        let fitted = Self::fit(mesh, &ordered, target)?;
        let report = fitted.report();
        Ok((Self { layout: fitted.layout, bits: fitted.bits, vertices: ordered }, report))
    }

    /// Encodes vertices in a given order, each [`BLOCK`] of them a block, without keeping their
    /// ids.
    pub(crate) fn from_blocks(
        mesh: &Mesh,
        ordered: &[VertexId],
        target: Accuracy,
    ) -> Result<Self, BlocksError> {
        let FittedBlocks { layout, bits, .. } = Self::fit(mesh, ordered, target)?;
        Ok(Self { layout, bits, vertices: Vec::new() })
    }

    fn fit(
        mesh: &Mesh,
        ordered: &[VertexId],
        target: Accuracy,
    ) -> Result<FittedBlocks, BlocksError> {
        let is_far =
            |v: &&VertexId| !mesh.positions[v.index()].iter().all(|x| x.abs() < MAX_COORDINATE);
        match ordered.iter().find(is_far) {
            Some(&v) => Err(BlocksError::NotFinite(v)),
            None => fit::fit_blocks(mesh, ordered, target),
        }
    }

    /// Returns the mesh vertex that each stored vertex comes from, in block order.
    ///
    /// Use it to renumber the connectivity. It is not part of the stored data.
    pub fn vertices(&self) -> &[VertexId] {
        &self.vertices
    }

    /// Returns the number of blocks. Vertex `i` is in block `i / 32`.
    pub fn blocks(&self) -> usize {
        self.layout.blocks()
    }

    /// Returns the matrix that maps the integer cells of a block to model units, as three rows of
    /// four.
    ///
    /// # Panics
    /// If there is no such block.
    pub fn matrix(&self, block: usize) -> [[f32; 4]; 3] {
        let ([u, v, w], first) = self.cells(&self.layout.header(&self.bits, block), block);
        [0, 1, 2].map(|k| [u[k], v[k], w[k], first[k]].map(|x| x as f32))
    }

    /// Returns the integer cell of a vertex, given by its index in [`VertexBlocks::vertices`].
    ///
    /// The matrix of the vertex's block maps the cell to a position.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn cell(&self, at: usize) -> [u32; 3] {
        assert!(at < self.layout.vertices, "there are {} vertices", self.layout.vertices);
        let header = self.layout.header(&self.bits, at / BLOCK);
        self.number(&header, self.layout.start(&self.bits, at / BLOCK), at % BLOCK)
    }

    /// Decodes the position of one vertex, given by its index in [`VertexBlocks::vertices`].
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn position(&self, at: usize) -> [f64; 3] {
        let header = self.layout.header(&self.bits, at / BLOCK);
        let (sides, first) = self.cells(&header, at / BLOCK);
        placed(&sides, first, self.cell(at))
    }

    /// Decodes the positions of all stored vertices, in block order.
    pub fn positions(&self) -> Vec<[f64; 3]> {
        let mut positions = Vec::with_capacity(self.layout.vertices);
        for block in 0..self.blocks() {
            let header = self.layout.header(&self.bits, block);
            let (sides, first) = self.cells(&header, block);
            let start = self.layout.start(&self.bits, block);
            let place = |at| placed(&sides, first, self.number(&header, start, at));
            positions.extend((0..BLOCK.min(self.layout.vertices - block * BLOCK)).map(place));
        }
        positions
    }

    /// Returns the compressed size of the positions in bytes, with everything needed to decode
    /// them.
    pub fn bytes(&self) -> usize {
        self.layout.bytes(&self.bits)
    }

    /// Returns the fraction of position storage saved, compared with three `f32` for each vertex; 0
    /// for an empty mesh.
    pub fn reduction(&self) -> f64 {
        reduction(self.bytes(), self.layout.vertices)
    }

    /// Returns the number of vertices.
    pub(crate) fn len(&self) -> usize {
        self.layout.vertices
    }

    /// Appends everything but [`VertexBlocks::vertices`] to `out`.
    pub(crate) fn store(&self, out: &mut Vec<u8>) {
        self.layout.store(&self.bits, out);
    }

    /// Reads what [`VertexBlocks::store`] wrote. The vertices of the mesh are unknown then.
    pub(crate) fn restore(reader: &mut Reader) -> Result<Self, Malformed> {
        let (layout, bits) = BlockLayout::restore(reader)?;
        Ok(Self { layout, bits, vertices: Vec::new() })
    }

    /// Returns the sides of a block's cells, and the middle of the first cell.
    fn cells(&self, header: &BlockHeader, block: usize) -> ([DVec3; 3], DVec3) {
        let (sides, first) = header.cells(&self.layout.units);
        (sides, self.layout.centre + (self.layout.middle(block) + first))
    }

    /// Returns the cell of a vertex. Two vertices share one number along each axis.
    fn number(&self, header: &BlockHeader, start: usize, at: usize) -> [u32; 3] {
        let mut start = start + header.bits() as usize * (at / 2);
        header.widths.map(|width| {
            let both = self.bits.get(start, width.into());
            start += usize::from(width);
            (if at.is_multiple_of(2) { both % numbers(width) } else { both / numbers(width) })
                as u32
        })
    }
}

/// Limit on coordinates: below it, fourth powers are finite in `f64`, and so is the `f32`.
const MAX_COORDINATE: f64 = 1e38;

fn placed(sides: &[DVec3; 3], first: DVec3, cell: [u32; 3]) -> [f64; 3] {
    let [u, v, w] = cell.map(f64::from);
    (sides[0] * u + sides[1] * v + sides[2] * w + first).to_array()
}
