//! Exact conservation of the volumes of the meshes of a scene.

use meshlod_io::{Format, Precision, Scene};
use meshlod_mesh::{Locks, Mesh};
use meshlod_simplify::{Digits, ExactVolumeError, SimplifyError, VolumeResidual, conserve_volume};

use crate::locks;

/// Returns the precision that positions have when a file of this format is read again.
pub fn digits_of(format: Format, precision: Precision) -> Digits {
    match (format, precision) {
        (Format::Stl | Format::Gltf | Format::Glb, _) | (Format::Ply, Precision::F32) => {
            Digits::F32
        }
        (Format::Obj | Format::Off | Format::Smf, Precision::F32) => Digits::Decimal,
        (_, Precision::F64) => Digits::F64,
    }
}

/// Moves vertices of every level so that it has the volume of its mesh, as
/// [`conserve_volume`] does.
///
/// `levels` belong to the meshes of `scene`, in that order, and `locks` count vertices through all
/// its meshes, see [`join_locks`](crate::join_locks). A level that cannot get the volume of its
/// mesh is left as it is. Volumes are exact in the space of each mesh, before the transforms of
/// nodes.
/// # Errors
/// Locks that do not match the scene.
pub fn conserve_volumes(
    scene: &Scene,
    levels: &mut [Mesh],
    digits: Digits,
    locks: &Locks,
) -> Result<Vec<Result<VolumeResidual, ExactVolumeError>>, SimplifyError> {
    let locks = locks::split(scene, locks)?;
    let pairs = levels.iter_mut().zip(&scene.meshes).zip(&locks);
    Ok(pairs.map(|((level, of), locks)| conserve_volume(level, &of.mesh, digits, locks)).collect())
}
