//! Repair of all meshes of a scene.

use meshlod_check::{RepairOptions, RepairReport, repair};
use meshlod_io::Scene;

/// Repairs every mesh of a scene, including meshes that no node shows; see [`repair`].
///
/// Nodes, materials and everything else stay, even materials that lose their last face. Lengths in
/// `options` are in the units of each mesh. Repairs of a mesh count once, however many nodes show
/// it.
pub fn repair_scene(scene: &mut Scene, options: &RepairOptions) -> RepairReport {
    let mut all = RepairReport::default();
    for mesh in &mut scene.meshes {
        let (repaired, report) = repair(&mesh.mesh, options);
        mesh.mesh = repaired;
        report.nonzero().for_each(|(step, count)| all.add(step, count));
    }
    all
}
