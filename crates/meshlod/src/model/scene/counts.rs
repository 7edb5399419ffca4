//! Numbers of the parts of a scene, for summaries.

use meshlod_io::Scene;
use meshlod_mesh::{LayerKind, Mesh};

/// Numbers of what a scene has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SceneCounts {
    /// Nodes, whether they show a mesh or not.
    pub nodes: usize,
    /// Meshes that the scene shows.
    pub meshes: usize,
    /// Meshes that it does not show. Of glTF they are kept as they are, of other formats left out.
    pub hidden_meshes: usize,
    /// Instances of meshes, at least as many as meshes shown.
    pub instances: usize,
    /// Materials.
    pub materials: usize,
    /// Images, including those without bytes.
    pub images: usize,
    /// Images whose file was not found.
    pub missing_images: usize,
    /// Skins.
    pub skins: usize,
    /// Animations.
    pub animations: usize,
    /// Shown meshes with joints.
    pub skinned_meshes: usize,
    /// Shown meshes with morph targets.
    pub morphing_meshes: usize,
}

impl SceneCounts {
    pub(super) fn of(scene: &Scene) -> Self {
        let instances = scene.instances();
        let mut is_shown = vec![false; scene.meshes.len()];
        instances.iter().for_each(|instance| is_shown[instance.mesh] = true);
        let shown = || scene.meshes.iter().zip(&is_shown).filter(|(_, shown)| **shown);
        let having = |is_meant: fn(LayerKind, &str) -> bool| {
            let has = |mesh: &Mesh| {
                let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
                layers.into_iter().any(|layer| is_meant(layer.kind, &layer.name))
            };
            shown().filter(|(mesh, _)| has(&mesh.mesh)).count()
        };
        let of_source = |key| scene.source.as_ref().map_or(0, |source| source.count(key));
        Self {
            nodes: scene.nodes.len(),
            meshes: shown().count(),
            hidden_meshes: is_shown.iter().filter(|shown| !**shown).count(),
            instances: instances.len(),
            materials: scene.materials.len(),
            images: scene.images.len(),
            missing_images: scene.images.iter().filter(|image| image.bytes.is_empty()).count(),
            skins: of_source("skins"),
            animations: of_source("animations"),
            skinned_meshes: having(|kind, _| matches!(kind, LayerKind::Joints(_))),
            morphing_meshes: having(|kind, name| {
                kind == LayerKind::Other && name.starts_with("target ")
            }),
        }
    }
}
