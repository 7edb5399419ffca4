//! Vertex positions in blocks, rounded to a lattice that meshes can share.

mod layout;
mod search;
mod shear;
mod stored;

use meshlod_mesh::{Bounds, Mesh, VertexId};
use thiserror::Error;

use self::layout::LatticeLayout;
use self::shear::MAX_CELLS;
pub use self::stored::{StoredLattice, StoredShear};
use crate::bytes::{Malformed, Reader, reduction};
use crate::kd::blocks_of;

/// Lattice of cubic cells whose side is a power of two, with a lattice point at the origin.
///
/// Equal positions stay equal, in whatever mesh and on whatever machine: a cell is stored as
/// integers, and decoding rounds once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Lattice {
    #[cfg_attr(feature = "serde", serde(deserialize_with = "valid_exponent"))]
    exponent: i32,
}

#[cfg(feature = "serde")]
fn valid_exponent<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<i32, D::Error> {
    let exponent = serde::Deserialize::deserialize(deserializer)?;
    Lattice::new(exponent).map(|lattice| lattice.exponent).map_err(serde::de::Error::custom)
}

/// Compressed positions of a mesh on a lattice, in blocks of 32 vertices that can be decoded
/// independently.
#[derive(Clone, Debug, PartialEq)]
pub struct LatticeBlocks {
    lattice: Lattice,
    /// Lowest cell along each axis.
    first: [i64; 3],
    layout: LatticeLayout,
    /// The mesh vertex that each stored vertex is; empty after decoding.
    vertices: Vec<VertexId>,
}

/// Reason why positions cannot be rounded to a lattice.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum LatticeError {
    /// A coordinate is infinite or NaN.
    #[error("{0} has a coordinate that is not finite")]
    NotFinite(VertexId),
    /// The mesh spans more lattice cells than the format can number.
    #[error("the mesh spans {cells:.0} cells, more than {MAX_CELLS}: use larger cells")]
    TooFine {
        /// Number of lattice cells along the longest side of the mesh.
        cells: f64,
    },
    /// The mesh is so far from the origin that `f64` cannot represent every lattice point there.
    #[error("the mesh is too far from the origin for cells of 2^{exponent}: use larger cells")]
    TooFar {
        /// Exponent of the lattice, whose cells have sides of 2^`exponent` model units.
        exponent: i32,
    },
    /// The exponent of the lattice is out of range.
    #[error("the cell's exponent must be between -960 and 960, not {0}")]
    Exponent(i32),
}

/// Size of the lattice's exponent and the least cell.
const HEADER: usize = 4 + 3 * 8;
/// Limit on cell numbers, up to which `f64` has every integer.
const MAX_NUMBER: f64 = (1u64 << 52) as f64;

impl Lattice {
    /// Creates a lattice whose cells have sides of 2^`exponent` model units.
    /// # Errors
    /// An exponent below -960 or above 960.
    pub fn new(exponent: i32) -> Result<Self, LatticeError> {
        let is_valid = (-960..=960).contains(&exponent);
        if is_valid { Ok(Self { exponent }) } else { Err(LatticeError::Exponent(exponent)) }
    }

    /// Creates the coarsest lattice whose cells have sides of at most `cell` model units.
    /// # Errors
    /// A size that is not positive, or too large or small.
    pub fn within(cell: f64) -> Result<Self, LatticeError> {
        let exponent = cell.log2().floor();
        // Also false for NaN.
        Self::new(if exponent.abs() <= 960.0 { exponent as i32 } else { i32::MAX })
    }

    /// Returns the lattice with cells of twice the side.
    /// # Errors
    /// As [`Lattice::new`].
    pub fn coarser(self) -> Result<Self, LatticeError> {
        Self::new(self.exponent + 1)
    }

    /// Returns the lattice with cells of half the side.
    /// # Errors
    /// As [`Lattice::new`].
    pub fn finer(self) -> Result<Self, LatticeError> {
        Self::new(self.exponent - 1)
    }

    /// Returns the side of a lattice cell, in model units.
    pub fn cell(self) -> f64 {
        f64::from(self.exponent).exp2()
    }

    /// Returns the index of the lattice vertex closest to a coordinate.
    fn number(self, x: f64) -> f64 {
        (x / self.cell()).round()
    }

    fn place(self, number: i64) -> f64 {
        number as f64 * self.cell()
    }
}

impl LatticeBlocks {
    /// Encodes the vertices that faces use, rounded to the lattice.
    ///
    /// Cost: O(n log n).
    /// # Errors
    /// A coordinate that is not finite, or too large for the lattice.
    pub fn new(mesh: &Mesh, lattice: Lattice) -> Result<Self, LatticeError> {
        let ordered = blocks_of(mesh);
        let blocks = Self::from_blocks(&mesh.positions, &ordered, lattice)?;
        Ok(Self { vertices: ordered, ..blocks })
    }

    /// Encodes vertices in a given order, each [`BLOCK`] of them a block, without keeping their
    /// ids.
    pub(crate) fn from_blocks(
        positions: &[[f64; 3]],
        ordered: &[VertexId],
        lattice: Lattice,
    ) -> Result<Self, LatticeError> {
        let place = |v: VertexId| positions[v.index()];
        let bad = ordered.iter().find(|&&v| !place(v).iter().all(|x| x.is_finite()));
        if let Some(&v) = bad {
            return Err(LatticeError::NotFinite(v));
        }
        let bounds = Bounds::of(ordered.iter().map(|v| &positions[v.index()]));
        let (first, most) = range(&bounds, lattice)?;
        let cell = |v: &VertexId| {
            [0, 1, 2].map(|k| (lattice.number(place(*v)[k]) as i64 - first[k]) as i32)
        };
        let cells: Vec<_> = ordered.iter().map(cell).collect();
        Ok(Self { lattice, first, layout: LatticeLayout::new(&cells, most), vertices: Vec::new() })
    }

    /// Returns the mesh vertex that each stored vertex comes from, in block order.
    ///
    /// Use it to renumber the connectivity. It is not part of the stored data.
    pub fn vertices(&self) -> &[VertexId] {
        &self.vertices
    }

    /// Decodes the position of one vertex, given by its index in [`LatticeBlocks::vertices`].
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn position(&self, at: usize) -> [f64; 3] {
        assert!(at < self.layout.vertices, "there are {} vertices", self.layout.vertices);
        self.place(self.layout.cell(at))
    }

    /// Decodes the positions of all stored vertices, in block order.
    pub fn positions(&self) -> Vec<[f64; 3]> {
        self.layout.cells().map(|cell| self.place(cell)).collect()
    }

    /// Returns the compressed size of the positions in bytes, with everything needed to decode
    /// them.
    pub fn bytes(&self) -> usize {
        HEADER + self.layout.bytes()
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

    /// Appends everything but [`LatticeBlocks::vertices`] to `out`.
    pub(crate) fn store(&self, out: &mut Vec<u8>) {
        out.extend(self.lattice.exponent.to_le_bytes());
        self.first.iter().for_each(|first| out.extend(first.to_le_bytes()));
        self.layout.store(out);
    }

    /// Reads what [`LatticeBlocks::store`] wrote. The vertices of the mesh are unknown then.
    pub(crate) fn restore(reader: &mut Reader) -> Result<Self, Malformed> {
        let lattice = Lattice::new(reader.i32()?).map_err(|why| reader.wrong(why.to_string()))?;
        let first = [reader.u64()?, reader.u64()?, reader.u64()?].map(u64::cast_signed);
        if first.iter().any(|&x| x.unsigned_abs() > MAX_NUMBER as u64) {
            return Err(reader.wrong("the first cell is too far away"));
        }
        let layout = LatticeLayout::restore(reader)?;
        Ok(Self { lattice, first, layout, vertices: Vec::new() })
    }

    fn place(&self, cell: [i64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| self.lattice.place(self.first[k] + cell[k]))
    }
}

/// Returns the range of cells along each axis: the first, and how many follow it.
fn range(bounds: &Bounds, lattice: Lattice) -> Result<([i64; 3], [i32; 3]), LatticeError> {
    let (mut first, mut most) = ([0; 3], [0; 3]);
    if bounds.is_empty() {
        return Ok((first, most));
    }
    for k in 0..3 {
        let [low, high] = [bounds.min[k], bounds.max[k]].map(|x| lattice.number(x));
        if high - low >= f64::from(MAX_CELLS) {
            return Err(LatticeError::TooFine { cells: high - low });
        }
        if low.abs().max(high.abs()) > MAX_NUMBER {
            return Err(LatticeError::TooFar { exponent: lattice.exponent });
        }
        (first[k], most[k]) = (low as i64, (high - low) as i32);
    }
    Ok((first, most))
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::mesh;
    use meshlod_samples as samples;

    use super::*;

    fn blocks(mesh: &Mesh, exponent: i32) -> LatticeBlocks {
        LatticeBlocks::new(mesh, Lattice::new(exponent).unwrap()).unwrap()
    }

    #[test]
    fn vertices_decode_alone_to_the_closest_lattice_vertex() {
        for mesh in [samples::sphere(5000), samples::gyroid(3000), samples::terrain(2000)] {
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
    fn shared_vertices_of_tiles_decode_equally() {
        let mesh = samples::gyroid(6000);
        for tiles in [2, 8, 64] {
            let mut places = vec![None; mesh.positions.len()];
            let mut shared = 0;
            for tile in tiled(&mesh, tiles) {
                let blocks = blocks(&tile, -8);
                for (&vertex, place) in blocks.vertices().iter().zip(blocks.positions()) {
                    // As the GPU has it.
                    let place = place.map(|x| (x as f32).to_bits());
                    shared += usize::from(places[vertex.index()].is_some());
                    assert_eq!(*places[vertex.index()].get_or_insert(place), place);
                }
            }
            assert!(shared > 20 * tiles / 2, "{shared}");
        }
    }

    /// Cuts a mesh into slabs along each axis in turn.
    fn tiled(mesh: &Mesh, tiles: usize) -> Vec<Mesh> {
        let mut parts = vec![mesh.faces.clone()];
        for axis in (0..3).cycle().take(tiles.ilog2() as usize) {
            let halve = |mut faces: Vec<[VertexId; 3]>| {
                faces.sort_by(|a, b| {
                    let along = |face: &[VertexId; 3]| mesh.positions[face[0].index()][axis];
                    along(a).total_cmp(&along(b))
                });
                let second = faces.split_off(faces.len() / 2);
                [faces, second]
            };
            parts = parts.into_iter().flat_map(halve).collect();
        }
        parts.into_iter().map(|faces| Mesh::new(mesh.positions.clone(), faces)).collect()
    }

    #[test]
    fn stored_data_comes_back_and_has_the_reported_size() {
        for mesh in [samples::sphere(5000), samples::terrain(2000), Mesh::default()] {
            for exponent in [-4, -11] {
                let blocks = blocks(&mesh, exponent);
                let bytes = stored(&blocks);
                assert_eq!(bytes.len(), blocks.bytes());
                let back = restored(&bytes).unwrap();
                assert_eq!(back.positions(), blocks.positions());
                assert!(back.vertices().iter().zip(0..).all(|(&v, at)| v == VertexId(at)));
                assert_eq!(stored(&back), bytes);
            }
        }
    }

    #[test]
    fn damaged_bytes_do_no_harm() {
        let bytes = stored(&blocks(&samples::gyroid(3000), -8));
        for length in (0..bytes.len()).step_by(7) {
            assert!(restored(&bytes[..length]).is_err());
        }
        let mut state = 1u64;
        let mut is_well = [0, 0];
        for turn in 0..4000 {
            let mut bytes = bytes.clone();
            for _ in 0..=turn % 3 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                // Half of the changes are in the parameters that all blocks share.
                let most = if turn % 2 == 0 { 70 } else { bytes.len() };
                bytes[(state >> 33) as usize % most] = (state >> 24) as u8;
            }
            let blocks = restored(&bytes);
            is_well[usize::from(blocks.is_ok())] += 1;
            if let Ok(blocks) = blocks {
                // With the largest exponents, damaged data may decode to infinite positions.
                let is_near = blocks.lattice.exponent < 900;
                assert!(!is_near || blocks.positions().iter().flatten().all(|x| x.is_finite()));
            }
        }
        assert!(is_well[0] > 500 && is_well[1] > 500, "{is_well:?}");
    }

    fn stored(blocks: &LatticeBlocks) -> Vec<u8> {
        let mut bytes = Vec::new();
        blocks.store(&mut bytes);
        bytes
    }

    fn restored(bytes: &[u8]) -> Result<LatticeBlocks, Malformed> {
        let mut reader = Reader::new(bytes);
        let blocks = LatticeBlocks::restore(&mut reader)?;
        reader.finish()?;
        Ok(blocks)
    }

    #[test]
    fn vertices_may_be_in_any_order_within_a_block() {
        let mesh = samples::sphere(3000);
        let mut ordered = blocks_of(&mesh);
        ordered.chunks_mut(32).for_each(<[_]>::reverse);
        let lattice = Lattice::new(-9).unwrap();
        let turned = LatticeBlocks::from_blocks(&mesh.positions, &ordered, lattice).unwrap();
        let plain = blocks(&mesh, -9);
        assert_eq!(turned.bytes(), plain.bytes());
        assert_eq!(turned.position(0), plain.position(31));
    }

    #[test]
    fn smooth_meshes_shrink_to_less_than_a_quarter() {
        // 11 bits of its longest side.
        let blocks = blocks(&samples::sphere(40_000), -10);
        assert!(blocks.reduction() > 0.8, "{}", blocks.reduction());
    }

    #[test]
    fn impossible_requests_are_refused() {
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
