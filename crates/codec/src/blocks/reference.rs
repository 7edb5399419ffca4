//! What blocks are to be as good as: cubic cells for the whole mesh.

use glam::DVec3;

use super::surface::Surface;
use super::{BlocksError, Change, Closeness};

/// Cubic cells, and what they do.
pub(super) struct Reference {
    /// The side of one.
    pub(super) cell: f64,
    pub(super) change: Change,
    /// The mean distance that is to be kept.
    pub(super) error: f64,
}

/// Cells along the longest side: at least, and at most.
const CELLS: [f64; 2] = [3.0, (1 << 24) as f64];
/// The mean distance to planes, in cells: where rounding happens to be exact, as on a flat mesh, that is no measure.
const LEAST_ERROR: f64 = 0.1;
const USUAL_ERROR: f64 = 0.2;
/// Of an error that is asked for: planes of faces tell it too low, by up to 4 % on a gyroid.
const SAFE: f64 = 0.96;

impl Reference {
    /// Cells that meet a target.
    ///
    /// `low` is the least corner of the mesh, `longest` its longest side.
    pub(super) fn new(
        surface: &Surface,
        low: DVec3,
        longest: f64,
        target: Closeness,
    ) -> Result<Self, BlocksError> {
        // One point is as it is in cells of any size.
        let longest = if longest > 0.0 { longest } else { f64::from(f32::MIN_POSITIVE) };
        match target {
            Closeness::Bits(bits) if !(2..=24).contains(&bits) => Err(BlocksError::Bits(bits)),
            Closeness::Bits(bits) => {
                let cell = longest / f64::from((1 << bits) - 1);
                let change = surface.change(&rounded(surface, low, cell));
                Ok(Self { cell, change, error: change.error_estimate.max(LEAST_ERROR * cell) })
            }
            Closeness::Error(error) if !(error > 0.0 && error.is_finite()) => {
                Err(BlocksError::Error(error))
            }
            Closeness::Error(error) => {
                let usual = (error / USUAL_ERROR).min(longest);
                let mean = surface.error(&rounded(surface, low, usual));
                let cell = usual * (error / mean.max(LEAST_ERROR * usual)).clamp(0.1, 10.0);
                if cell < longest / CELLS[1] {
                    return Err(BlocksError::TooFine(error));
                }
                let cell = cell.min(longest / CELLS[0]);
                let change = surface.change(&rounded(surface, low, cell));
                Ok(Self { cell, change, error: SAFE * error.min(USUAL_ERROR * longest) })
            }
        }
    }
}

/// How far rounding to cells moves each vertex.
fn rounded(surface: &Surface, low: DVec3, cell: f64) -> Vec<DVec3> {
    let moved = |&place: &DVec3| ((place - low) / cell).round() * cell + low - place;
    surface.places.iter().map(moved).collect()
}
