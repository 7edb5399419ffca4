//! Exact conservation of volume for all meshes of a scene.

use glam::DMat4;
use meshlod_io::{Format, MeshInstance, Precision, Scene, StoredDigits};
use meshlod_measure::volume;
use meshlod_mesh::{Mesh, closed_faces, is_balanced};
use meshlod_simplify::{Digits, ExactVolumeError, VolumeResidual, conserve_volume};

use crate::conditioned::ConditionedMesh;
use crate::scene::ConditionedScene;

/// Returns the number format in which a mesh file stores positions, given its format and precision;
/// [`Precision::Auto`] counts as 32 bits.
pub fn digits_of(format: Format, precision: Precision) -> Digits {
    match format.stored_digits(precision) {
        StoredDigits::F32 => Digits::F32,
        StoredDigits::F64 => Digits::F64,
        StoredDigits::Decimal => Digits::Decimal,
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

/// Returns the volume of a scene in cubic world units: the sum over all instances of the absolute
/// volumes of the [closed components](closed_faces) of their meshes.
///
/// Cost: O(n), n = faces, and a copy of the positions.
pub fn closed_volume(scene: &Scene) -> f64 {
    volume_by(scene, of_closed)
}

/// Returns the [`closed_volume`] of a scene of which no face repeats another, in a fifth of the time
/// where its meshes have no boundary (horse-97k).
///
/// Cost: O(n), n = faces. Faces that repeat others count as often as they are there.
pub fn closed_volume_of_distinct(scene: &Scene) -> f64 {
    volume_by(scene, |mesh| if is_balanced(mesh) { volume(mesh) } else { of_closed(mesh) })
}

fn volume_by(scene: &Scene, of_mesh: impl Fn(&Mesh) -> f64) -> f64 {
    let volumes: Vec<f64> = scene.meshes.iter().map(|of| of_mesh(&of.mesh).abs()).collect();
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
