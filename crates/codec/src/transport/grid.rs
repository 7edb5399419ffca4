//! Quantization of positions to cubic cells.

use glam::DVec3;
use meshlod_mesh::{Mesh, VertexId};

use super::predict::{CellVec, MAX_CELLS};
use super::{TransportError, TransportQuantization};

/// Grid of cubic cells from an origin on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct QuantizationGrid {
    pub(super) origin: [f64; 3],
    pub(super) cell: f64,
}

/// Greatest number of bits of a coordinate.
pub(super) const MAX_BITS: u32 = MAX_CELLS.trailing_zeros();
/// Limit on coordinates, which leaves some room in `f32`.
pub(super) const MAX_COORDINATE: f64 = 1e38;

impl QuantizationGrid {
    /// Builds the requested grid, and finds the cell of each vertex that a face uses; zero for the
    /// others.
    pub(super) fn of(
        mesh: &Mesh,
        grid: TransportQuantization,
    ) -> Result<(Self, Vec<CellVec>), TransportError> {
        let count = mesh.positions.len();
        let is_bad = |v: &&VertexId| {
            !mesh
                .positions
                .get(v.index())
                .is_some_and(|p| p.iter().all(|x| x.abs() <= MAX_COORDINATE))
        };
        match mesh.faces.iter().flatten().find(is_bad) {
            Some(v) if v.index() < count => return Err(TransportError::NotFinite(*v)),
            Some(v) => return Err(TransportError::BadVertex(*v)),
            None => {}
        }
        let bounds = mesh.bounds();
        let longest = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
        let this = match grid {
            TransportQuantization::Bits(bits) if !(1..=MAX_BITS).contains(&bits) => {
                return Err(TransportError::Bits(bits));
            }
            TransportQuantization::Bits(bits) => {
                let cell = longest / f64::from((1u32 << bits) - 1);
                // If all vertices are in one place, any cell will do.
                let cell = if cell > f64::MIN_POSITIVE { cell } else { 1.0 };
                Self { origin: bounds.min, cell }
            }
            TransportQuantization::Lattice(lattice) => {
                let cell = lattice.cell();
                let origin = bounds.min.map(|x| (x / cell).round() * cell);
                if !origin.iter().all(|x| (x / cell).abs() <= (1u64 << 52) as f64) {
                    return Err(TransportError::TooFar);
                }
                Self { origin, cell }
            }
        };
        let is_lattice = matches!(grid, TransportQuantization::Lattice(_));
        // On a lattice both ends are rounded.
        let cells = (longest / this.cell).round() + f64::from(u8::from(is_lattice));
        if cells >= f64::from(MAX_CELLS) {
            return Err(TransportError::TooFine { cells });
        }
        let used = mesh.used_vertices();
        let cell = |(p, &used): (&[f64; 3], &bool)| match (used, is_lattice) {
            (false, _) => CellVec::ZERO,
            (true, true) => this.number(p),
            (true, false) => this.cell_of(p),
        };
        Ok((this, mesh.positions.iter().zip(&used).map(cell).collect()))
    }

    /// Returns the cell on a lattice, which depends on the position alone and not on the origin.
    fn number(&self, position: &[f64; 3]) -> CellVec {
        let number = |x: f64| (x / self.cell).round();
        let along = |k: usize| (number(position[k]) - number(self.origin[k])) as f32;
        CellVec::new(along(0), along(1), along(2))
    }

    fn cell_of(&self, position: &[f64; 3]) -> CellVec {
        let along = |k: usize| ((position[k] - self.origin[k]) / self.cell).round() as f32;
        CellVec::new(along(0), along(1), along(2)).max(CellVec::ZERO)
    }

    /// Returns the position of a cell, which on a lattice is exact.
    #[inline(always)]
    pub(super) fn place(&self, cell: CellVec) -> [f64; 3] {
        (DVec3::from(self.origin) + self.cell * cell.as_dvec3()).to_array()
    }
}
