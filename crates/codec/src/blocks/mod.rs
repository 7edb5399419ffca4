//! Each vertex in one block of 32, in cells that lie as the surface does.

mod fit;
mod frame;
mod layout;
mod reference;
mod settle;
mod shape;
mod surface;
#[cfg(test)]
mod tests;

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};
use thiserror::Error;

use self::layout::Layout;
use self::shape::{Shape, numbers};
use crate::bits::Bits;
use crate::bytes::{Malformed, Reader};
use crate::kd::{BLOCK, blocks_of};

/// The positions of a mesh in blocks of 32, each with a matrix that puts small whole numbers where they belong.
///
/// Each vertex is in one block, and faces may have corners in several: nothing is stored twice, and there are no
/// borders to crack. Any vertex is decoded alone, and to the same bits on every machine.
#[derive(Clone, Debug, PartialEq)]
pub struct VertexBlocks {
    layout: Layout,
    /// Headers and numbers, group by group.
    bits: Bits,
    /// The vertex of the mesh that each is.
    vertices: Vec<VertexId>,
}

/// How close decoded positions are to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Closeness {
    /// As close as so many bits for the whole mesh: cubic cells, 2^bits − 1 along its longest side, rounded.
    Bits(u32),
    /// The mean distance of the surfaces, in model units.
    Error(f64),
}

impl Closeness {
    /// A little less close: by a bit, or a quarter of one.
    pub(crate) fn coarser(self) -> Option<Self> {
        match self {
            Self::Bits(bits) => (bits > 2).then_some(Self::Bits(bits - 1)),
            Self::Error(error) => Some(Self::Error(error * f64::exp2(0.25))),
        }
    }
}

/// What became of the surface, beside what becomes of it in cubic cells of the whole mesh that are as close.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BlocksReport {
    /// In blocks.
    pub blocks: Change,
    /// In cubic cells.
    pub cubes: Change,
    /// The side of those, in model units.
    pub cube: f64,
    /// How many blocks are finer than the rest, for a face that would be turned over or a vertex too far off.
    pub finer: usize,
}

/// How far a surface is from what it was. Estimates, by the faces around each vertex; lengths in model units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// The mean distance of its points to the planes of their faces.
    pub error_estimate: f64,
    /// The greatest distance between a vertex and the other surface.
    pub max_estimate: f64,
    /// Faces that are turned by more than a right angle, or left without area.
    pub flips: usize,
}

/// Why a mesh is not put in blocks.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BlocksError {
    /// A number that is none, or too large for `f32`.
    #[error("{0} has a coordinate that is not finite, or beyond 1e38")]
    NotFinite(VertexId),
    /// Too few or too many bits.
    #[error("{0} bits are not matched: ask for 2 to 24")]
    Bits(u32),
    /// Not a distance.
    #[error("a distance of {0} cannot be kept: give a positive one, in model units")]
    Error(f64),
    /// More cells than are numbered.
    #[error("a distance of {0:e} takes more than 24 bits an axis: allow a larger one")]
    TooFine(f64),
}

impl VertexBlocks {
    /// The positions that faces of a mesh use, with as few bits as a target allows; and how far that takes them.
    ///
    /// Beside the mean, no vertex is to be farther from the other surface than twice as far as in the cubic cells
    /// that are as close, and no more faces are to be turned over: blocks where that fails are made finer, a few
    /// times. The report says what remains.
    ///
    /// Cost: O(n log n); a few dozen visits of each face.
    /// # Errors
    /// A coordinate that is none, a target that is none or too fine.
    pub fn new(mesh: &Mesh, target: Closeness) -> Result<(Self, BlocksReport), BlocksError> {
        Self::of_blocks(mesh, blocks_of(mesh), target)
    }

    /// The same, every [`BLOCK`] of `ordered` a block: in whatever order within.
    pub(crate) fn of_blocks(
        mesh: &Mesh,
        ordered: Vec<VertexId>,
        target: Closeness,
    ) -> Result<(Self, BlocksReport), BlocksError> {
        let is_far = |v: &&VertexId| !mesh.positions[v.index()].iter().all(|x| x.abs() < MOST);
        if let Some(&v) = ordered.iter().find(is_far) {
            return Err(BlocksError::NotFinite(v));
        }
        let (layout, bits, report) = fit::fitted(mesh, &ordered, target)?;
        Ok((Self { layout, bits, vertices: ordered }, report))
    }

    /// The vertex of the mesh that each is, in the order of the blocks. Connectivity is renumbered by it; it is not
    /// part of what is stored.
    pub fn vertices(&self) -> &[VertexId] {
        &self.vertices
    }

    /// How many blocks there are. Vertex `i` is in block `i / 32`.
    pub fn blocks(&self) -> usize {
        self.layout.blocks()
    }

    /// What puts the cells of a block where they belong: three rows of four, model units.
    ///
    /// # Panics
    /// A block that there is not.
    pub fn matrix(&self, block: usize) -> [[f32; 4]; 3] {
        let ([u, v, w], first) = self.cells(&self.layout.shape(&self.bits, block), block);
        [0, 1, 2].map(|k| [u[k], v[k], w[k], first[k]].map(|x| x as f32))
    }

    /// The cell of a vertex, by its place among [`VertexBlocks::vertices`]: what its block's matrix is for.
    ///
    /// # Panics
    /// A place that there is not.
    pub fn cell(&self, at: usize) -> [u32; 3] {
        assert!(at < self.layout.vertices, "there are {} vertices", self.layout.vertices);
        let shape = self.layout.shape(&self.bits, at / BLOCK);
        self.number(&shape, self.layout.start(&self.bits, at / BLOCK), at % BLOCK)
    }

    /// Where a vertex is: no other is decoded.
    ///
    /// # Panics
    /// A place that there is not.
    pub fn position(&self, at: usize) -> [f64; 3] {
        let shape = self.layout.shape(&self.bits, at / BLOCK);
        let (sides, first) = self.cells(&shape, at / BLOCK);
        placed(&sides, first, self.cell(at))
    }

    /// Where all vertices are.
    pub fn positions(&self) -> Vec<[f64; 3]> {
        let mut positions = Vec::with_capacity(self.layout.vertices);
        for block in 0..self.blocks() {
            let shape = self.layout.shape(&self.bits, block);
            let (sides, first) = self.cells(&shape, block);
            let start = self.layout.start(&self.bits, block);
            let place = |at| placed(&sides, first, self.number(&shape, start, at));
            positions.extend((0..BLOCK.min(self.layout.vertices - block * BLOCK)).map(place));
        }
        positions
    }

    /// What positions take, with all that decoding them needs, in bytes.
    pub fn bytes(&self) -> usize {
        self.layout.bytes(&self.bits)
    }

    /// How much less that is than three `f32` for each vertex, as a part; nothing of nothing.
    pub fn reduction(&self) -> f64 {
        match self.layout.vertices {
            0 => 0.0,
            count => 1.0 - self.bytes() as f64 / (12 * count) as f64,
        }
    }

    /// How many vertices there are.
    pub(crate) fn len(&self) -> usize {
        self.layout.vertices
    }

    /// Without knowing which vertex of the mesh is which, as from a file.
    pub(crate) fn forgetful(self) -> Self {
        Self { vertices: Vec::new(), ..self }
    }

    /// Puts all but [`VertexBlocks::vertices`] behind other bytes.
    pub(crate) fn store(&self, out: &mut Vec<u8>) {
        self.layout.store(&self.bits, out);
    }

    /// What was stored: it does not say which vertex is which.
    pub(crate) fn restore(reader: &mut Reader) -> Result<Self, Malformed> {
        let (layout, bits) = Layout::restore(reader)?;
        Ok(Self { layout, bits, vertices: Vec::new() })
    }

    /// The sides of a block's cells, and the middle of the first.
    fn cells(&self, shape: &Shape, block: usize) -> ([DVec3; 3], DVec3) {
        let (sides, first) = shape.cells(&self.layout.units);
        (sides, self.layout.centre + (self.layout.middle(block) + first))
    }

    /// The numbers of a vertex: two have one together along each axis.
    fn number(&self, shape: &Shape, start: usize, at: usize) -> [u32; 3] {
        let mut start = start + shape.bits() as usize * (at / 2);
        shape.widths.map(|width| {
            let both = self.bits.get(start, width.into());
            start += usize::from(width);
            (if at.is_multiple_of(2) { both % numbers(width) } else { both / numbers(width) })
                as u32
        })
    }
}

/// Coordinates below have a square of a square, and an `f32`.
const MOST: f64 = 1e38;

fn placed(sides: &[DVec3; 3], first: DVec3, cell: [u32; 3]) -> [f64; 3] {
    let [u, v, w] = cell.map(f64::from);
    (sides[0] * u + sides[1] * v + sides[2] * w + first).to_array()
}
