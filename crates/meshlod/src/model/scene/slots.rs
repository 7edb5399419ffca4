//! Material labels of the levels of a scene.

use std::collections::{BTreeMap, BTreeSet};

use meshlod_io::{Material, Scene};

use super::head::Slot;

/// Lists the material labels of a merged scene: its materials, in order, and then what repeats
/// within a mesh. Repeated labels without material have one too, but for the first.
pub(super) fn slots_of(scene: &Scene) -> Vec<Slot> {
    let all = (0..scene.materials.len() as u32).map(|i| Slot { material: Some(i), ordinal: 0 });
    let mut slots: Vec<Slot> = all.collect();
    let mut repeated = BTreeSet::new();
    for mesh in &scene.meshes {
        repeated
            .extend(slots_of_labels(&mesh.materials).into_iter().filter(|slot| slot.ordinal > 0));
    }
    slots.extend(repeated);
    slots
}

/// Returns the slot of each material label of a mesh, given their materials.
pub(super) fn slots_of_labels(materials: &[Option<usize>]) -> Vec<Slot> {
    let mut seen = BTreeMap::new();
    let slot = |material: &Option<usize>| {
        let material = material.map(|material| material as u32);
        let ordinal = seen.entry(material).or_insert(0);
        *ordinal += 1;
        Slot { material, ordinal: *ordinal - 1 }
    };
    materials.iter().map(slot).collect()
}

pub(super) fn material_of(scene: &Scene, slot: Slot) -> Material {
    let material = slot.material.and_then(|index| scene.materials.get(index as usize));
    material.cloned().unwrap_or_default()
}
