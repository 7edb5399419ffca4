//! Reference for the accuracy of blocks: cubic cells over the whole mesh.

use glam::DVec3;

use super::original::OriginalSurface;
use super::report::{Accuracy, BlocksError, SurfaceChange};

/// Cubic cells as accurate as the target, and the error that they cause.
pub(super) struct CubicReference {
    /// Side of a cell.
    pub(super) cell: f64,
    pub(super) change: SurfaceChange,
    /// Mean distance that the blocks must keep.
    pub(super) error: f64,
}

/// Minimum and maximum number of cells along the longest side.
const CELLS: [f64; 2] = [3.0, (1 << 24) as f64];
/// Least and usual mean distance to planes, in cells. Where rounding happens to be exact, as on a
/// flat mesh, the measured distance is no guide.
const LEAST_ERROR: f64 = 0.1;
const USUAL_ERROR: f64 = 0.2;
/// Factor on a requested error. Planes of faces underestimate it by up to 4 % on a gyroid.
const SAFE: f64 = 0.96;

impl CubicReference {
    /// Finds cubic cells that meet a target.
    ///
    /// `low` is the least corner of the mesh, `longest` its longest side.
    pub(super) fn new(
        surface: &OriginalSurface,
        low: DVec3,
        longest: f64,
        target: Accuracy,
    ) -> Result<Self, BlocksError> {
        // A single point stays where it is in cells of any size.
        let longest = if longest > 0.0 { longest } else { f64::from(f32::MIN_POSITIVE) };
        match target {
            Accuracy::Bits(bits) if !(2..=24).contains(&bits) => Err(BlocksError::Bits(bits)),
            Accuracy::Bits(bits) => {
                let cell = longest / f64::from((1 << bits) - 1);
                let change = surface.change(&rounded(surface, low, cell));
                Ok(Self { cell, change, error: change.error_estimate.max(LEAST_ERROR * cell) })
            }
            Accuracy::Error(error) if !(error > 0.0 && error.is_finite()) => {
                Err(BlocksError::Error(error))
            }
            Accuracy::Error(error) => {
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

/// Returns how rounding to cells moves each vertex.
fn rounded(surface: &OriginalSurface, low: DVec3, cell: f64) -> Vec<DVec3> {
    let moved = |&place: &DVec3| ((place - low) / cell).round() * cell + low - place;
    surface.places.iter().map(moved).collect()
}
