//! Blocks as they are stored, for renderers.

use super::VertexBlocks;
use super::header::numbers;
use super::layout::GROUP;
use crate::kd::BLOCK;

/// Positions in blocks as an `.mlq` file stores them: bits, and headers decoded to matrices.
///
/// Vertex `i` is in block `i / 32`. Vertices `2 k` and `2 k + 1` of a block share a number along
/// each axis, of [`StoredBlock::widths`] bits. The numbers of pair `k` start at bit
/// `start + k · (sum of the widths)`; the first vertex is the remainder by ⌊√2^width⌋, the second one
/// the quotient.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredBlocks<'a> {
    /// Number of vertices.
    pub vertices: usize,
    /// Centre of the mesh, in model units.
    pub centre: [f64; 3],
    /// Bits, from the lowest of the first word on.
    pub words: &'a [u64],
    /// Headers of the blocks.
    pub blocks: Vec<StoredBlock>,
}

/// Header of a block: the matrix that places its cells, and where its numbers are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoredBlock {
    /// Sides of a cell along its three axes, in model units.
    pub sides: [[f64; 3]; 3],
    /// Middle of the first cell relative to the centre of the mesh, in model units.
    pub first: [f64; 3],
    /// Bits of a pair of vertices along each axis, at most 56.
    pub widths: [u8; 3],
    /// Bit at which the numbers of the block start.
    pub start: u64,
}

impl StoredBlock {
    /// Returns the largest offset in cells between the two vertices of a pair.
    pub fn cells(&self, axis: usize) -> u64 {
        numbers(self.widths[axis])
    }
}

impl VertexBlocks {
    /// Returns the blocks as they are stored.
    pub(crate) fn stored(&self) -> StoredBlocks<'_> {
        let mut start = 0;
        let blocks = (0..self.blocks()).map(|block| {
            if block % GROUP == 0 {
                start = self.layout.start(&self.bits, block) as u64;
            }
            let header = self.layout.header(&self.bits, block);
            let (sides, first) = header.cells(&self.layout.units);
            let stored = StoredBlock {
                sides: sides.map(|side| side.to_array()),
                first: (self.layout.middle(block) + first).to_array(),
                widths: header.widths,
                start,
            };
            start += u64::from(header.bits()) * (BLOCK / 2) as u64;
            stored
        });
        StoredBlocks {
            vertices: self.layout.vertices,
            centre: self.layout.centre.to_array(),
            blocks: blocks.collect(),
            words: self.bits.words(),
        }
    }
}
