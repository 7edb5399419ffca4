//! Scenes repaired as a whole.

use meshlod_check::{RepairOptions, RepairReport, repair};
use meshlod_io::Scene;

/// Repairs every mesh of a scene in its own space, also those that no node shows; see [`repair`].
///
/// Nodes, materials and all else stay, and so do the names of materials that lose their last face.
/// Lengths in `options` are in the units of each mesh. Counts are of meshes, however often they are
/// shown.
pub fn repair_scene(scene: &mut Scene, options: &RepairOptions) -> RepairReport {
    let mut all = RepairReport::default();
    for mesh in &mut scene.meshes {
        let (repaired, report) = repair(&mesh.mesh, options);
        mesh.mesh = repaired;
        report.nonzero().for_each(|(step, count)| all.add(step, count));
    }
    all
}
