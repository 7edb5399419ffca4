//! Two-sided distance between the surfaces of two meshes, enclosed between bounds.
//!
//! Samples give a lower bound of the maximum, and nothing says how far below it they are. Here each
//! face of one surface is divided until no part of it can be farther from the other surface than a
//! point already found, but for a tolerance.

mod beyond;
mod cell;
mod rounding;
mod search;

use meshlod_mesh::Mesh;

pub use crate::certified::beyond::{BeyondOptions, FaceBeyond, FacesBeyond, faces_beyond};
use crate::certified::rounding::Rounding;
use crate::certified::search::Search;
use crate::distance::{MeasureError, Place};
use crate::prepared::PreparedSurface;

/// Options for a certified distance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct CertifiedOptions {
    /// Greatest difference of the two bounds of each direction, relative to the lower one.
    pub tolerance: f64,
    /// Distance that counts as none, as a part of the longer diagonal: where the maximum is below,
    /// the upper bound need not be.
    ///
    /// Where equal planes are divided into different faces, the maximum is 0, and the work is
    /// inverse to this.
    pub floor: f64,
    /// Limit on the divisions of faces in each direction; 130 bytes of memory each at worst.
    ///
    /// Where it ends the search, the bounds hold all the same but are farther apart.
    pub most_splits: usize,
}

impl Default for CertifiedOptions {
    fn default() -> Self {
        Self { tolerance: 0.01, floor: 1e-5, most_splits: 4_000_000 }
    }
}

impl CertifiedOptions {
    /// Returns options by which a distance is told from one of `enough` diagonals, or of the usual
    /// floor if that is less.
    pub fn up_to(enough: f64) -> Self {
        let usual = Self::default();
        Self { floor: usual.floor.min(enough), ..usual }
    }
}

/// Returns the least distance of other surfaces from this one, of about the same extent, that can be
/// proved, in model units: some roundings of `f64`.
pub fn least_provable(surface: &PreparedSurface<'_>) -> f64 {
    Rounding::between(surface.mesh, surface.mesh).least()
}

/// Maximum distance between two surfaces A and B in both directions, each between two bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CertifiedDistance {
    /// Greatest distance of a point on A from the surface B.
    pub forward: Bracket,
    /// Greatest distance of a point on B from the surface A.
    pub backward: Bracket,
    /// Length of the diagonal of A's bounding box, in model units.
    pub diagonal: f64,
}

/// Lower and upper bound of a distance, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Bracket {
    /// Lower bound: the distance at `place`, less what rounding may have added.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
    /// Points on both surfaces where the lower bound was found.
    pub place: Place,
    /// Whether the bounds are as close as was asked for, or both within the floor.
    pub reached: bool,
    /// Number of divisions of faces that it took.
    pub splits: usize,
}

impl CertifiedDistance {
    /// Returns bounds of the Hausdorff distance: the greater direction's.
    pub fn symmetric(&self) -> Bracket {
        let (a, b) = (self.forward, self.backward);
        let Bracket { lower, place, .. } = if b.lower > a.lower { b } else { a };
        let (reached, splits) = (a.reached && b.reached, a.splits + b.splits);
        Bracket { lower, upper: a.upper.max(b.upper), place, reached, splits }
    }

    /// Converts a length in model units to a percentage of the diagonal of A's bounding box.
    pub fn percent(&self, length: f64) -> f64 {
        100.0 * length / self.diagonal
    }
}

/// Encloses the maximum distance between the surfaces of two meshes, in both directions.
///
/// Each direction starts with all vertices. A part of a face is discarded once an upper bound of
/// its distances is below what was found or at most the tolerance above it; the others are divided
/// along their longest edge, those of the greatest bounds first. The upper bounds are the smaller
/// of two: distances grow by no more than the way from a point where they are known, and the
/// distance from one face of the other mesh is convex, so greatest at a corner of the part. Bounds
/// allow for the rounding of `f64`. The result is the same to the bit for any number of threads.
///
/// Cost: O((vertices + faces + splits) log faces); in parallel.
///
/// # Errors
/// A mesh that is invalid or has zero area.
///
/// # References
/// [SJ24] for the search and the first bound; differs: bisection, in rounds that threads share. The
/// second bound is that of [TLK09], its candidates those of [KKYK18].
pub fn certified_distance(
    a: &Mesh,
    b: &Mesh,
    options: &CertifiedOptions,
) -> Result<CertifiedDistance, MeasureError> {
    let a = PreparedSurface::new(a).map_err(MeasureError::First)?;
    let b = PreparedSurface::new(b).map_err(MeasureError::Second)?;
    Ok(certified_surface_distance(&a, &b, options))
}

/// Measures the [`certified_distance`] between two prepared surfaces, which saves time if a surface
/// is measured more than once.
pub fn certified_surface_distance(
    a: &PreparedSurface<'_>,
    b: &PreparedSurface<'_>,
    options: &CertifiedOptions,
) -> CertifiedDistance {
    let [forward, backward] =
        [(a, b), (b, a)].map(|(from, to)| certified_one_way(from, to, options));
    CertifiedDistance { forward, backward, diagonal: a.diagonal }
}

/// Encloses the greatest distance of a point on one prepared surface from another, in one direction
/// only; see [`certified_distance`].
pub fn certified_one_way(
    from: &PreparedSurface<'_>,
    to: &PreparedSurface<'_>,
    options: &CertifiedOptions,
) -> Bracket {
    let mut search = Search::new(from, to, options);
    search.run();
    search.bracket()
}

#[cfg(test)]
mod tests;
