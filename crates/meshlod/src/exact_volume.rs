//! The levels of a scene with the volumes of its meshes.

use meshlod_io::{Format, Precision, Scene};
use meshlod_mesh::{Locks, Mesh};
use meshlod_simplify::{Digits, ExactVolumeError, SimplifyError, VolumeResidual, conserve_volume};

use crate::locks;

/// The numbers that positions come to be when a file of this kind is read again.
pub fn digits_of(format: Format, precision: Precision) -> Digits {
    match (format, precision) {
        (Format::Stl | Format::Gltf | Format::Glb, _) | (Format::Ply, Precision::F32) => {
            Digits::F32
        }
        (Format::Obj | Format::Off | Format::Smf, Precision::F32) => Digits::Decimal,
        (_, Precision::F64) => Digits::F64,
    }
}

/// Gives every level the volume of its mesh, as [`conserve_volume`] does, each in its own space: what
/// a node's transform rounds when it is written out comes on top.
///
/// `levels` are of the meshes of `scene`, in their order, and `locks` those of all its meshes. A level
/// that cannot have its mesh's volume is left as it is.
/// # Errors
/// Locks that are not for this scene.
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
