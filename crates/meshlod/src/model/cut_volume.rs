//! Exact conservation of volume for cuts of a multiresolution file.

use meshlod_mesh::{Locks, Mesh};
use meshlod_multires::{FileError, ModelFile, Query, Source};
use meshlod_simplify::{Digits, ExactVolumeError, VolumeResidual, conserve_volume};
use thiserror::Error;

/// Reason why a cut cannot get the volume of the finest cut in its file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CutVolumeError {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The file is truncated.
    #[error(
        "{there} of {all} chunks are there, so the volume of the finest cut is unknown: use the whole file"
    )]
    Truncated {
        /// Number of chunks present in full.
        there: usize,
        /// Number of chunks of the whole file.
        all: usize,
    },
    /// The finest cut has no volume, or the cut cannot get it.
    #[error(transparent)]
    Volume(#[from] ExactVolumeError),
}

/// Adjusts the vertices of a cut from a multiresolution file until its closed components have the
/// volume of the finest cut's; see [`conserve_volume`].
///
/// In a lossless file the finest cut is the mesh that it was built from. Otherwise its volume is that
/// of the rounded vertices. The file does not hold locks, so locked vertices move, too.
///
/// Cost: that of reading the whole file.
/// # Errors
/// A truncated or damaged file, and what [`conserve_volume`] refuses. The cut is then unchanged.
pub fn conserve_cut_volume<S: Source>(
    cut: &mut Mesh,
    file: &ModelFile<S>,
    digits: Digits,
) -> Result<VolumeResidual, CutVolumeError> {
    let [there, all] = file.pieces();
    if there < all {
        return Err(CutVolumeError::Truncated { there, all });
    }
    let finest = file.extract(&Query::finest())?.level.mesh();
    Ok(conserve_volume(cut, &finest, digits, &Locks::default())?)
}
