//! Exact conservation of volume for all meshes of a scene.

use meshlod_io::{Format, Precision, Scene};
use meshlod_mesh::{Locks, Mesh};
use meshlod_simplify::{Digits, ExactVolumeError, SimplifyError, VolumeResidual, conserve_volume};

use crate::locks;

/// Returns the number format in which a mesh file stores positions, given its format and precision.
pub fn digits_of(format: Format, precision: Precision) -> Digits {
    match (format, precision) {
        (Format::Stl | Format::Gltf | Format::Glb, _) | (Format::Ply, Precision::F32) => {
            Digits::F32
        }
        (Format::Obj | Format::Off | Format::Smf, Precision::F32) => Digits::Decimal,
        (_, Precision::F64) => Digits::F64,
    }
}

/// Adjusts the vertices of each simplified mesh until it has the volume of the original; see
/// [`conserve_volume`].
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
