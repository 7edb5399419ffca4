//! Levels of a whole scene, taken apart into its meshes.

use std::collections::BTreeMap;

use meshlod_io::Scene;
use meshlod_mesh::{Labels, Mesh};

use super::head::{MeshEntry, Slot};
use super::selector::Selector;
use super::slots::slots_of_labels;
use super::take_back::take_back;
use super::weights::mend_weights;

/// Puts the faces of a level into the empty meshes of its scene; `None` if they do not fit. `rounded`
/// tells that positions and attributes have been rounded.
///
/// Cost: linear.
pub(super) fn split(
    level: &Mesh,
    entries: &[Option<MeshEntry>],
    slots: &[Slot],
    rounded: bool,
    scene: &mut Scene,
) -> Option<()> {
    let placed: Vec<usize> = (0..entries.len()).filter(|&m| entries[m].is_some()).collect();
    let (owners, firsts) = owners_of_objects(level, entries)?;
    let mut faces = vec![Vec::new(); entries.len()];
    for face in 0..level.faces.len() {
        let owner = match &level.objects {
            Some(objects) => *owners.get(objects.of(face) as usize)?,
            None => *placed.first().filter(|_| placed.len() == 1)?,
        };
        faces[owner].push(face as u32);
    }
    let mut selector = Selector::new(level);
    for index in placed {
        let (entry, into) = (entries[index].as_ref()?, scene.meshes.get_mut(index)?);
        let faces = &faces[index];
        let mut mesh = selector.faces(faces);
        mesh.attributes = selector.attributes(faces, &entry.layers)?;
        let names = into.mesh.materials.take().map_or_else(Vec::new, |labels| labels.names);
        let of_face = labels_of(level, faces, slots, &into.materials)?;
        mesh.materials = Some(Labels { names, of_face });
        mesh.objects = objects_of(level, faces, firsts[index], entry.objects);
        take_back(&mut mesh, entry.placement, !rounded)?;
        if rounded {
            mend_weights(&mut mesh);
        }
        into.mesh = mesh;
    }
    Some(())
}

/// Returns the material label of each face among those of its mesh, which have these materials.
fn labels_of(
    level: &Mesh,
    faces: &[u32],
    slots: &[Slot],
    materials: &[Option<usize>],
) -> Option<Vec<u32>> {
    let of_slots: BTreeMap<Slot, u32> = slots_of_labels(materials).into_iter().zip(0..).collect();
    let label = |face: &u32| {
        let labels = level.materials.as_ref();
        let slot = labels.and_then(|labels| slots.get(labels.of(*face as usize) as usize));
        of_slots.get(&slot.copied().unwrap_or_default()).copied()
    };
    faces.iter().map(label).collect()
}

/// Returns the objects of some faces: `count` of the level's from the first one on.
fn objects_of(level: &Mesh, faces: &[u32], first: u32, count: Option<u32>) -> Option<Labels> {
    let (objects, count) = level.objects.as_ref().zip(count)?;
    let names = objects.names[first as usize..(first + count) as usize].to_vec();
    let of_face = faces.iter().map(|&face| objects.of(face as usize) - first);
    Some(Labels { names, of_face: of_face.collect() })
}

/// Returns the mesh of each object of a level, and the first object of each mesh; `None` if there
/// are more objects or fewer than the meshes have.
fn owners_of_objects(
    level: &Mesh,
    entries: &[Option<MeshEntry>],
) -> Option<(Vec<usize>, Vec<u32>)> {
    let Some(objects) = &level.objects else { return Some((Vec::new(), vec![0; entries.len()])) };
    let (mut owners, mut firsts) = (Vec::new(), vec![0; entries.len()]);
    for (index, entry) in entries.iter().enumerate() {
        let Some(entry) = entry else { continue };
        firsts[index] = owners.len() as u32;
        let end = owners.len().checked_add(entry.objects.unwrap_or(1) as usize)?;
        if end > objects.names.len() {
            return None;
        }
        owners.resize(end, index);
    }
    (owners.len() == objects.names.len()).then_some((owners, firsts))
}
