//! Nodes that show the meshes of a scene, and in how many ways.

use glam::DMat4;
use meshlod_io::gltf::{Animator, Pose};
use meshlod_io::{MeshInstance, Node, Scene};
use meshlod_mesh::Layer;

use super::mesh_pose::{MeshPose, PoseLayers};
use super::scene_poses::PosedMesh;

/// Nodes that show each mesh.
#[derive(Clone, Debug, Default)]
pub(super) struct Shown {
    pub(super) meshes: Vec<ShownMesh>,
}

/// Nodes that show one mesh, each with the transform of one of its copies.
#[derive(Clone, Debug, Default)]
pub(super) struct ShownMesh {
    /// Nodes that change its shape.
    pub(super) deforming: Vec<(usize, DMat4)>,
    /// Nodes that move it as it is.
    rigid: Vec<(usize, DMat4)>,
    pub(super) layers: PoseLayers,
    back: DMat4,
}

impl Shown {
    pub(super) fn of(
        scene: &Scene,
        meshes: &[Option<PosedMesh>],
        layers: &[Layer],
        animator: &Animator,
    ) -> Self {
        let roles = PoseLayers::of(layers);
        let mut shown: Vec<ShownMesh> =
            meshes.iter().map(|mesh| ShownMesh::of(mesh.as_ref(), &roles)).collect();
        for (node, mesh, copy) in copies(scene) {
            let Some(mesh) = shown.get_mut(mesh).filter(|_| meshes[mesh].is_some()) else {
                continue;
            };
            match mesh.layers.deforms(animator, node) {
                true => mesh.deforming.push((node, copy)),
                false => mesh.rigid.push((node, copy)),
            }
        }
        Self { meshes: shown }
    }

    /// Returns the largest number of ways in which a mesh is shown at one moment.
    pub(super) fn variants(&self) -> usize {
        let of_mesh = |mesh: &ShownMesh| mesh.deforming.len() + usize::from(!mesh.rigid.is_empty());
        self.meshes.iter().map(of_mesh).max().unwrap_or(0)
    }

    /// Returns how each mesh is shown in a pose, in one of these ways or the last that it has: by one
    /// of the nodes that change its shape, or of the others by the one that enlarges it most.
    pub(super) fn pose(
        &self,
        animator: &Animator,
        pose: &Pose,
        variant: usize,
    ) -> Vec<Option<MeshPose>> {
        let of_mesh = |mesh: &ShownMesh| {
            let posed =
                |&at: &(usize, DMat4)| MeshPose::new(animator, pose, at, (&mesh.layers, mesh.back));
            if let Some(at) = mesh.deforming.get(variant) {
                return Some(posed(at));
            }
            let larger = |most: MeshPose, next: MeshPose| {
                if next.stretch() > most.stretch() { next } else { most }
            };
            let most = mesh.rigid.iter().map(posed).reduce(larger);
            most.or_else(|| mesh.deforming.last().map(posed))
        };
        self.meshes.iter().map(of_mesh).collect()
    }
}

impl ShownMesh {
    /// A mesh that no node shows yet.
    fn of(mesh: Option<&PosedMesh>, roles: &PoseLayers) -> Self {
        let own = mesh.map_or(&[][..], |mesh| &mesh.layers);
        Self {
            layers: roles.of_mesh(|layer| own.contains(&(layer as u32))),
            back: mesh.map_or(DMat4::IDENTITY, |mesh| mesh.back),
            ..Self::default()
        }
    }
}

/// Lists the copies of meshes that a scene shows: node, mesh and transform to the node's space.
pub(super) fn copies(scene: &Scene) -> Vec<(usize, usize, DMat4)> {
    let mut instances: Vec<MeshInstance> = scene.instances();
    instances.dedup_by_key(|instance| instance.node);
    let of_node = |instance: MeshInstance| {
        let Node { instances, .. } = &scene.nodes[instance.node];
        let only = std::iter::repeat_n(DMat4::IDENTITY, usize::from(instances.is_empty()));
        let all = only.chain(instances.iter().map(DMat4::from_cols_array_2d));
        all.map(move |copy| (instance.node, instance.mesh, copy)).collect::<Vec<_>>()
    };
    instances.into_iter().flat_map(of_node).collect()
}
