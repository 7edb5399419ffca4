//! Vertices in blocks, on a lattice that meshes can share.

mod shape;

use meshlod_mesh::{Bounds, Mesh, VertexId};
use thiserror::Error;

use self::shape::{MOST_CELLS, SLOPE_BITS, SPAN_BITS, Shape, axes};
use crate::bits::Bits;
use crate::kd::{BLOCK, blocks_of};

/// Cubic cells of a power of two, with a vertex of the lattice at the origin.
///
/// What lies in one place before is in one place afterwards, whatever mesh it is in and whatever machine it is on:
/// cells are told by whole numbers, and decoding rounds once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lattice {
    exponent: i32,
}

/// The positions of a mesh on a lattice, in blocks of which each is decoded alone.
#[derive(Clone, Debug, PartialEq)]
pub struct LatticeBlocks {
    lattice: Lattice,
    /// The least cell along each axis that has a vertex, and the greatest from there on.
    first: [i64; 3],
    most: [i32; 3],
    /// The vertex of the mesh that each is.
    vertices: Vec<VertexId>,
    headers: Bits,
    numbers: Bits,
    /// Where the numbers of every [`STRIDE`]-th block start.
    starts: Vec<u32>,
}

/// Why positions are not put on a lattice.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum LatticeError {
    /// A number that is none.
    #[error("{0} has a coordinate that is not finite")]
    NotFinite(VertexId),
    /// More cells than are numbered.
    #[error(
        "the mesh spans {cells:.0} cells: more than {MOST_CELLS} are not numbered; take larger ones"
    )]
    TooFine {
        /// How many.
        cells: f64,
    },
    /// Cells that are too far away.
    #[error("the mesh is so far from the origin that cells of 2^{exponent} are not told apart")]
    TooFar {
        /// The power of two.
        exponent: i32,
    },
    /// A cell that is no number.
    #[error("cells of 2^{0} cannot be: take an exponent from -1000 to 1000")]
    Exponent(i32),
}

/// The lattice's exponent, how many vertices there are, and the cells that they are in.
const HEADER: usize = 2 * 4 + 3 * (8 + 4);
const AXIS_BITS: u32 = 2;
/// What is told in place of a slope of zero.
const SLOPE_ZERO: i32 = 1 << (SLOPE_BITS - 1);
/// So many blocks share the place where they start.
const STRIDE: usize = 16;
/// Beyond, `f64` does not have every whole number of cells.
const FARTHEST: f64 = (1u64 << 52) as f64;

impl Lattice {
    /// Cells of 2^`exponent` model units.
    /// # Errors
    /// An exponent below -1000 or above 1000.
    pub fn new(exponent: i32) -> Result<Self, LatticeError> {
        let is_one = (-1000..=1000).contains(&exponent);
        if is_one { Ok(Self { exponent }) } else { Err(LatticeError::Exponent(exponent)) }
    }

    /// The coarsest with cells no larger than that.
    /// # Errors
    /// A size that is not positive, or too large or small.
    pub fn within(cell: f64) -> Result<Self, LatticeError> {
        let exponent = cell.log2().floor();
        // Also of what is no number.
        Self::new(if exponent.abs() <= 1000.0 { exponent as i32 } else { i32::MAX })
    }

    /// With cells half as large.
    /// # Errors
    /// As [`Lattice::new`].
    pub fn finer(self) -> Result<Self, LatticeError> {
        Self::new(self.exponent - 1)
    }

    /// The side of a cell, in model units.
    pub fn cell(self) -> f64 {
        f64::from(self.exponent).exp2()
    }

    /// The number of the lattice's vertex closest to a place, along an axis.
    fn number(self, x: f64) -> f64 {
        (x / self.cell()).round()
    }

    fn place(self, number: i64) -> f64 {
        number as f64 * self.cell()
    }
}

impl LatticeBlocks {
    /// The positions that faces of a mesh use, moved to the closest vertices of a lattice.
    ///
    /// Cost: O(n log n).
    /// # Errors
    /// A mesh with a coordinate that is none, or too large for the lattice.
    pub fn new(mesh: &Mesh, lattice: Lattice) -> Result<Self, LatticeError> {
        Self::of_blocks(&mesh.positions, blocks_of(mesh), lattice)
    }

    /// The same of some of the positions, every [`BLOCK`] of `ordered` a block: in whatever order within.
    pub(crate) fn of_blocks(
        positions: &[[f64; 3]],
        ordered: Vec<VertexId>,
        lattice: Lattice,
    ) -> Result<Self, LatticeError> {
        let place = |v: VertexId| positions[v.index()];
        let bad = ordered.iter().find(|&&v| !place(v).iter().all(|x| x.is_finite()));
        if let Some(&v) = bad {
            return Err(LatticeError::NotFinite(v));
        }
        let bounds = Bounds::of(ordered.iter().map(|v| &positions[v.index()]));
        let (first, most) = range(&bounds, lattice)?;
        let mut this = Self {
            lattice,
            first,
            most,
            vertices: ordered,
            headers: Bits::default(),
            numbers: Bits::default(),
            starts: Vec::new(),
        };
        let cell =
            |v: VertexId| [0, 1, 2].map(|k| (lattice.number(place(v)[k]) as i64 - first[k]) as i32);
        for block in 0..this.vertices.len().div_ceil(BLOCK) {
            let rest = &this.vertices[block * BLOCK..];
            let cells: Vec<_> = rest.iter().take(BLOCK).map(|&v| cell(v)).collect();
            if block % STRIDE == 0 {
                this.starts.push(this.numbers.len() as u32);
            }
            this.push(&Shape::of(&cells, most), &cells);
        }
        Ok(this)
    }

    /// The vertex of the mesh that each is, in the order of the blocks. Connectivity is renumbered by it; it is not
    /// part of what is stored.
    pub fn vertices(&self) -> &[VertexId] {
        &self.vertices
    }

    /// Where a vertex is, by its place among [`LatticeBlocks::vertices`]: no other block is decoded.
    ///
    /// # Panics
    /// A place that there is not.
    pub fn position(&self, at: usize) -> [f64; 3] {
        assert!(at < self.vertices.len(), "there are {} vertices", self.vertices.len());
        let block = at / BLOCK;
        let stride = block - block % STRIDE;
        let before = (stride..block).map(|before| self.shape(before).bits() as usize * BLOCK);
        let start = self.starts[block / STRIDE] as usize + before.sum::<usize>();
        let shape = self.shape(block);
        self.decode(&shape, start + at % BLOCK * shape.bits() as usize)
    }

    /// Where all vertices are.
    pub fn positions(&self) -> Vec<[f64; 3]> {
        let mut positions = Vec::with_capacity(self.vertices.len());
        let mut at = 0;
        for block in 0..self.vertices.len().div_ceil(BLOCK) {
            let shape = self.shape(block);
            for _ in 0..BLOCK.min(self.vertices.len() - positions.len()) {
                positions.push(self.decode(&shape, at));
                at += shape.bits() as usize;
            }
        }
        positions
    }

    /// What positions take, with all that decoding them needs, in bytes.
    pub fn bytes(&self) -> usize {
        let bits = self.headers.len().div_ceil(8) + self.numbers.len().div_ceil(8);
        HEADER + bits + size_of_val(&self.starts[..])
    }

    /// How much less that is than three `f32` for each vertex, as a part.
    pub fn reduction(&self) -> f64 {
        1.0 - self.bytes() as f64 / (12 * self.vertices.len()) as f64
    }

    /// Puts all but [`LatticeBlocks::vertices`] behind other bytes.
    pub(crate) fn store(&self, out: &mut Vec<u8>) {
        out.extend(self.lattice.exponent.to_le_bytes());
        out.extend((self.vertices.len() as u32).to_le_bytes());
        out.extend(self.first.iter().flat_map(|x| x.to_le_bytes()));
        out.extend(self.most.iter().flat_map(|x| x.to_le_bytes()));
        self.headers.store(out);
        out.extend(self.starts.iter().flat_map(|x| x.to_le_bytes()));
        self.numbers.store(out);
    }

    /// What was stored: each vertex is the one of its place.
    pub(crate) fn restore(reader: &mut crate::bytes::Reader) -> Result<Self, crate::Malformed> {
        let lattice = Lattice::new(reader.i32()?).map_err(|e| reader.wrong(e.to_string()))?;
        let count = reader.u32()? as usize;
        let mut first = [0i64; 3];
        for x in &mut first {
            *x = reader.u64()? as i64;
        }
        let mut most = [0i32; 3];
        for x in &mut most {
            *x = reader.i32()?.clamp(0, MOST_CELLS - 1);
        }
        let mut this = Self {
            lattice,
            first,
            most,
            vertices: Vec::new(),
            headers: Bits::default(),
            numbers: Bits::default(),
            starts: Vec::new(),
        };
        let all: u32 = (0..3).map(|k| this.width(0, k)).sum();
        let blocks = count.div_ceil(BLOCK);
        this.headers = Bits::restore(
            blocks * (AXIS_BITS + 3 * (SLOPE_BITS + SPAN_BITS) + all) as usize,
            reader,
        )?;
        for _ in 0..blocks.div_ceil(STRIDE) {
            this.starts.push(reader.u32()?);
        }
        this.vertices = (0..count).map(VertexId::new).collect();
        let bits =
            (0..blocks).map(|b| this.shape(b).bits() as usize * BLOCK.min(count - b * BLOCK)).sum();
        this.numbers = Bits::restore(bits, reader)?;
        Ok(this)
    }

    fn decode(&self, shape: &Shape, at: usize) -> [f64; 3] {
        let cell = shape.cell(self.numbers.get(at, shape.bits()));
        [0, 1, 2].map(|k| self.lattice.place(self.first[k] + i64::from(cell[k])))
    }

    fn push(&mut self, shape: &Shape, cells: &[[i32; 3]]) {
        self.headers.push(shape.axis.into(), AXIS_BITS);
        for slope in shape.slopes {
            self.headers.push((i32::from(slope) + SLOPE_ZERO) as u64, SLOPE_BITS);
        }
        for (k, span) in shape.spans.into_iter().enumerate() {
            self.headers.push(span.into(), SPAN_BITS);
            self.headers.push(shape.least[k] as u64, self.width(shape.axis, k));
        }
        cells.iter().for_each(|&cell| self.numbers.push(shape.number(cell), shape.bits()));
    }

    fn shape(&self, block: usize) -> Shape {
        let all: u32 = (0..3).map(|k| self.width(0, k)).sum();
        let mut at = block * (AXIS_BITS + 3 * (SLOPE_BITS + SPAN_BITS) + all) as usize;
        let mut next = |width: u32| {
            at += width as usize;
            self.headers.get(at - width as usize, width)
        };
        let mut shape = Shape { axis: next(AXIS_BITS) as u8, ..Shape::default() };
        shape.slopes = [0; 3].map(|_: i8| (next(SLOPE_BITS) as i32 - SLOPE_ZERO) as i8);
        for k in 0..3 {
            shape.spans[k] = next(SPAN_BITS) as u8;
            shape.least[k] = next(self.width(shape.axis, k)) as i32;
        }
        shape
    }

    /// How many bits the least of a block takes along its axes.
    fn width(&self, axis: u8, k: usize) -> u32 {
        u32::BITS - self.most[axes(axis)[k]].leading_zeros()
    }
}

/// Cells from the first to the last along each axis: the number of the first, and how many follow it.
fn range(bounds: &Bounds, lattice: Lattice) -> Result<([i64; 3], [i32; 3]), LatticeError> {
    let (mut first, mut most) = ([0; 3], [0; 3]);
    if bounds.is_empty() {
        return Ok((first, most));
    }
    for k in 0..3 {
        let [low, high] = [bounds.min[k], bounds.max[k]].map(|x| lattice.number(x));
        if high - low >= f64::from(MOST_CELLS) {
            return Err(LatticeError::TooFine { cells: high - low });
        }
        if low.abs().max(high.abs()) > FARTHEST {
            return Err(LatticeError::TooFar { exponent: lattice.exponent });
        }
        (first[k], most[k]) = (low as i64, (high - low) as i32);
    }
    Ok((first, most))
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::mesh;
    use meshlod_mesh::sample;

    use super::*;

    fn blocks(mesh: &Mesh, exponent: i32) -> LatticeBlocks {
        LatticeBlocks::new(mesh, Lattice::new(exponent).unwrap()).unwrap()
    }

    #[test]
    fn vertices_are_at_the_closest_of_the_lattice_and_each_is_found_alone() {
        for mesh in [sample::sphere(5000), sample::gyroid(3000), sample::terrain(2000)] {
            let blocks = blocks(&mesh, -9);
            let positions = blocks.positions();
            assert_eq!(positions.len(), mesh.positions.len());
            for (at, (&vertex, &is)) in blocks.vertices().iter().zip(&positions).enumerate() {
                let was = mesh.positions[vertex.index()];
                let closest = was.map(|x| (x * 512.0).round() / 512.0);
                assert_eq!(is, closest);
                assert!(at % 37 != 0 || blocks.position(at) == is);
            }
        }
    }

    #[test]
    fn what_two_meshes_share_is_the_same_in_both() {
        let mesh = sample::gyroid(4000);
        let half = |is_first: bool| {
            let is_in =
                |face: &&[VertexId; 3]| (mesh.positions[face[0].index()][0] < 0.1) == is_first;
            Mesh::new(mesh.positions.clone(), mesh.faces.iter().filter(is_in).copied().collect())
        };
        let mut places = vec![None; mesh.positions.len()];
        let mut shared = 0;
        for half in [half(true), half(false)] {
            let blocks = blocks(&half, -8);
            for (&vertex, place) in blocks.vertices().iter().zip(blocks.positions()) {
                let place = place.map(f64::to_bits);
                shared += usize::from(places[vertex.index()].is_some());
                assert_eq!(*places[vertex.index()].get_or_insert(place), place);
            }
        }
        assert!(shared > 20, "{shared}");
    }

    #[test]
    fn smooth_meshes_shrink_to_less_than_a_quarter() {
        // 11 bits of its longest side.
        let blocks = blocks(&sample::sphere(40_000), -10);
        assert!(blocks.reduction() > 0.78, "{}", blocks.reduction());
    }

    #[test]
    fn what_cannot_be_is_said() {
        let far = |x: f64| mesh(&[[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]], &[[0, 1, 2]]);
        let ask =
            |mesh: &Mesh, exponent| LatticeBlocks::new(mesh, Lattice::new(exponent).unwrap()).err();
        assert_eq!(ask(&far(0.0), -10), None);
        assert!(matches!(ask(&far(0.0), -20), Some(LatticeError::TooFine { .. })));
        assert!(matches!(ask(&far(1e15), -10), Some(LatticeError::TooFar { .. })));
        assert_eq!(ask(&far(f64::NAN), -10), Some(LatticeError::NotFinite(VertexId(0))));
        assert_eq!(ask(&Mesh::default(), -10), None);
        assert!(Lattice::new(2000).is_err() && Lattice::within(f64::NAN).is_err());
        assert!(Lattice::within(0.0).is_err() && Lattice::within(-1.0).is_err());
        assert_eq!(Lattice::within(0.3).unwrap().cell(), 0.25);
    }
}
