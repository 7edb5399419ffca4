//! Exact conservation of volume for all meshes of a scene.

use glam::DMat4;
use meshlod_io::{Format, MeshInstance, Precision, Scene};
use meshlod_measure::volume;
use meshlod_mesh::{Locks, Mesh, closed_faces};
use meshlod_multires::{FileError, ModelFile, Query, Source};
use meshlod_simplify::{Digits, ExactVolumeError, VolumeResidual, conserve_volume};
use thiserror::Error;

use crate::ConditionedScene;
use crate::conditioned::ConditionedMesh;

/// Returns the number format in which a mesh file stores positions, given its format and precision;
/// [`Precision::Auto`] counts as 32 bits.
pub fn digits_of(format: Format, precision: Precision) -> Digits {
    match (format, precision) {
        (Format::Stl | Format::Gltf | Format::Glb, _) => Digits::F32,
        (_, Precision::F64) => Digits::F64,
        (Format::Ply, _) => Digits::F32,
        (Format::Obj | Format::Off | Format::Smf, _) => Digits::Decimal,
    }
}

/// Adjusts the vertices of each simplified mesh until it has the volume of the original; see
/// [`conserve_volume`].
///
/// `levels` belong to the meshes of the scene, in that order; borders that conditioning has sewn
/// count as closed. A level that cannot get the volume of its mesh is left as it is. Volumes are
/// exact in the space of each mesh, before the transforms of nodes.
pub fn conserve_volumes(
    scene: &ConditionedScene<'_>,
    levels: &mut [Mesh],
    digits: Digits,
) -> Vec<Result<VolumeResidual, ExactVolumeError>> {
    let conserve = |(level, of): (&mut Mesh, &ConditionedMesh<'_>)| {
        conserve_volume(level, of.mesh(), digits, of.locks())
    };
    levels.iter_mut().zip(&scene.meshes).map(conserve).collect()
}

/// Reason why a cut cannot get the volume of the finest cut in its file.
#[derive(Debug, Error)]
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
    /// The cut is only a part of its surface.
    #[error("a cropped cut encloses no volume: extract the whole one")]
    Cropped,
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

/// Returns the volume of a scene in cubic world units: the sum over all instances of the absolute
/// volumes of the [closed components](closed_faces) of their meshes.
///
/// Cost: O(n), n = faces, and a copy of the positions.
pub fn closed_volume(scene: &Scene) -> f64 {
    let volumes: Vec<f64> = scene.meshes.iter().map(|of| of_closed(&of.mesh).abs()).collect();
    let scaled = |place: &MeshInstance| {
        volumes[place.mesh] * DMat4::from_cols_array_2d(&place.transform).determinant().abs()
    };
    scene.instances().iter().map(scaled).sum()
}

fn of_closed(mesh: &Mesh) -> f64 {
    let is_closed = closed_faces(&mesh.faces, mesh.positions.len());
    let closed = mesh.faces.iter().zip(is_closed).filter(|(_, is_closed)| *is_closed);
    let faces = closed.map(|(face, _)| *face).collect();
    volume(&Mesh::new(mesh.positions.clone(), faces))
}
