//! Scenes on their way into a compressed file: one mesh, and all else beside it.

use meshlod_io::Scene;
use meshlod_mesh::Mesh;
use meshlod_simplify::Options;

use super::request::CompressRequest;
use crate::Constraints;
use crate::jobs::{About, JobError, Remark, Watch};
use crate::model::{PackedScene, SceneCounts, place_scene};

/// Scene that is ready to be compressed.
pub(super) struct Placed {
    /// Every mesh of the scene, once.
    pub mesh: Mesh,
    /// The rest of the scene, encoded; empty if the scene is only a mesh.
    pub rest: Vec<u8>,
    /// Numbers of what the scene has; `None` if it is only a mesh.
    pub counts: Option<SceneCounts>,
}

/// Merges a scene into the mesh to compress, and packs the rest. Remarks on what is not kept.
pub(super) fn place(
    mut scene: Scene,
    request: &CompressRequest,
    watch: &dyn Watch,
) -> Result<Placed, JobError> {
    if request.lock_contacts && has_copies(&scene) {
        let reason = "--lock-contacts: several nodes show the same mesh, so the file has one mesh \
                      with all copies; materials keep their base colour and its texture, and \
                      nodes, skins and animations are left out";
        watch.remark(&Remark::new(About::Input, reason));
        scene = flattened(scene, &request.name);
    }
    let placed = place_scene(scene, &Constraints::default(), Options::default());
    let placed = placed.map_err(JobError::input)?;
    let counts = placed.rest.is_some().then_some(placed.counts);
    let rest = placed.rest.as_ref().map(PackedScene::to_bytes).transpose();
    let rest = rest.map_err(JobError::input)?.unwrap_or_default();
    Ok(Placed { mesh: placed.mesh, rest, counts })
}

/// Returns true if several nodes show the same mesh.
fn has_copies(scene: &Scene) -> bool {
    let mut shown: Vec<usize> = scene.instances().iter().map(|instance| instance.mesh).collect();
    shown.sort_unstable();
    shown.windows(2).any(|pair| pair[0] == pair[1])
}

/// Returns a scene of one mesh with a copy for each instance, which one grid rounds alike.
fn flattened(mut scene: Scene, name: &str) -> Scene {
    let (materials, images) = (scene.materials.clone(), std::mem::take(&mut scene.images));
    let mut flat = Scene::from_mesh(name, scene.into_mesh());
    // Faces without a material have one more label.
    let of_label =
        |label: &mut Option<usize>| *label = label.filter(|&label| label < materials.len());
    flat.meshes.iter_mut().flat_map(|mesh| &mut mesh.materials).for_each(of_label);
    Scene { materials, images, ..flat }
}
