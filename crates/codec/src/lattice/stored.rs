//! Lattice blocks as they are stored, for renderers.

use super::LatticeBlocks;
use super::shear::span;

/// Positions on a lattice as an `.mlq` file stores them: bits, and the shears of the blocks.
///
/// Vertex `i` is in block `i / 32`, at `2^exponent · (first + cell)`.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredLattice<'a> {
    /// Number of vertices.
    pub vertices: usize,
    /// Exponent of the side of a lattice cell, -960 to 960.
    pub exponent: i32,
    /// Lowest cell along each axis.
    pub first: [i64; 3],
    /// Greatest cell along each axis relative to `first`, below 2¹⁹.
    pub most: [i32; 3],
    /// Bits, from the lowest of the first word on.
    pub words: &'a [u64],
    /// Headers of the blocks.
    pub blocks: Vec<StoredShear>,
}

/// Header of a lattice block: the integer shear that is undone, and where its numbers are.
///
/// Axes `u`, `v` and `w` are x, y and z turned so that `w` is [`StoredShear::axis`]. A vertex is a
/// digit of a number, in base `u span · v span · w span`; the digit has that of `u` lowest. With half
/// the span, rounded down, taken off each, quotients rounded down, and one after the other:
/// `v += slopes[1] u / 64`, `u += slopes[0] v / 64`, `w += slopes[2] u / 64 + slopes[3] v / 64`, and
/// `w += u (bends[0] u + bends[1] v) / (64 · u span) + bends[2] v v / (64 · v span)`. Adding the
/// middle gives the cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StoredShear {
    /// Axis that is flattened, 0 to 2.
    pub axis: u8,
    /// Four slopes, in units of 1/64.
    pub slopes: [i8; 4],
    /// Three bends, in units of 1/64.
    pub bends: [i8; 3],
    /// Middle of the block along `u`, `v` and `w`, in cells relative to the mesh's first one.
    pub middle: [i32; 3],
    /// Codes of the spans of `u`, `v` and `w`, see [`StoredShear::spans`].
    pub span_codes: [u8; 3],
    /// Vertices that share a number, the first one lowest: 4, or 1 if more than 128 bits would be
    /// needed.
    pub tuple: u8,
    /// Bits of such a number, at most 128.
    pub width: u8,
    /// Bit at which the numbers of the block start.
    pub start: u64,
}

impl StoredShear {
    /// Returns how many cells the block spans along `u`, `v` and `w`, at most 2¹⁹ each: for a code
    /// below 16 the code + 1, for others (code mod 16 + 17) · 2^(code / 16 − 1).
    pub fn spans(&self) -> [u64; 3] {
        self.span_codes.map(span)
    }
}

impl LatticeBlocks {
    /// Returns the blocks as they are stored.
    pub(crate) fn stored(&self) -> StoredLattice<'_> {
        let blocks = self.layout.transforms().into_iter().map(|(transform, start)| {
            let (tuple, width) = transform.tuple();
            StoredShear {
                axis: transform.axis % 3,
                slopes: transform.slopes,
                bends: transform.bends,
                middle: transform.middle,
                span_codes: transform.spans,
                tuple: tuple as u8,
                width: width as u8,
                start: start as u64,
            }
        });
        StoredLattice {
            vertices: self.layout.vertices,
            exponent: self.lattice.exponent,
            first: self.first,
            most: self.layout.most,
            words: self.layout.words(),
            blocks: blocks.collect(),
        }
    }
}
