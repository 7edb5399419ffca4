//! Scenes posed by their animations: skins, morph targets and moving nodes.
//!
//! [`ScenePoses`] poses the levels of a scene while their errors are measured; [`posed_mesh`] poses
//! any scene, to look at it or to compare it with another.

mod mesh_pose;
mod scene_poses;
mod shown;
#[cfg(test)]
mod tests;

use glam::DMat4;
use meshlod_io::Scene;
use meshlod_io::gltf::{Animator, Moment};
use meshlod_mesh::{Mesh, VertexId};

use mesh_pose::{MeshPose, PoseLayers};
pub(crate) use scene_poses::PosedMesh;
pub use scene_poses::{PoseCounts, ScenePoses};

/// Returns the surface that a scene shows at a moment of an animation, or without one as its nodes
/// stand; in world space, with a vertex for each set of attributes.
///
/// Skins and morph targets are applied. Levels of one scene are posed alike, as all have its
/// animations.
///
/// Cost: linear in the faces shown.
pub fn posed_mesh(scene: &Scene, animator: &Animator, moment: Option<Moment>) -> Mesh {
    let pose = animator.pose(moment);
    let mut posed = Mesh::default();
    for (node, mesh, copy) in shown::copies(scene) {
        let mesh = &scene.meshes[mesh].mesh;
        let attributes = mesh.attributes.as_ref();
        let layers = attributes.map_or(&[][..], |all| &all.layers);
        let roles = PoseLayers::of(layers);
        let moved = MeshPose::new(animator, &pose, (node, copy), (&roles, DMat4::IDENTITY));
        let first = posed.positions.len();
        let wedges = attributes.map_or(mesh.positions.len(), |all| all.wedge_count);
        posed.positions.resize(first + wedges, [0.0; 3]);
        for (index, face) in mesh.faces.iter().enumerate() {
            let corners = mesh.corner_wedges(index);
            for (wedge, v) in corners.into_iter().zip(face) {
                let place = moved.place(mesh.positions[v.index()], (&roles, layers), wedge);
                posed.positions[first + wedge.index()] = place.to_array();
            }
            posed.faces.push(corners.map(|wedge| VertexId::new(first + wedge.index())));
        }
    }
    posed
}
