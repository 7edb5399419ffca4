//! Edits of a mesh together with its attributes and labels.

use meshlod_mesh::{FaceId, Mesh, VertexId, WedgeId};
use rustc_hash::FxHashMap;

/// Removes the faces for which `keeps` is false, with their corners, labels and
/// numbers; returns how many they were.
pub fn retain_faces(mesh: &mut Mesh, keeps: impl Fn(usize) -> bool) -> usize {
    let before = mesh.faces.len();
    if (0..before).all(&keeps) {
        return 0;
    }
    retain(&mut mesh.faces, &keeps);
    if let Some(attributes) = &mut mesh.attributes {
        retain(&mut attributes.corners, &keeps);
    }
    label_arrays(mesh).for_each(|labels| retain(labels, &keeps));
    mesh.face_layers.iter_mut().for_each(|layer| retain(&mut layer.values, &keeps));
    before - mesh.faces.len()
}

fn retain<T>(items: &mut Vec<T>, keeps: impl Fn(usize) -> bool) {
    let mut index = 0;
    items.retain(|_| {
        index += 1;
        keeps(index - 1)
    });
}

fn label_arrays(mesh: &mut Mesh) -> impl Iterator<Item = &mut Vec<u32>> {
    mesh.materials.iter_mut().chain(&mut mesh.objects).map(|labels| &mut labels.of_face)
}

/// Appends the labels and the numbers of a face once more, for a new face that comes from it.
pub fn repeat_face_values(mesh: &mut Mesh, face: FaceId) {
    let face = face.index();
    label_arrays(mesh).for_each(|labels| labels.push(labels[face]));
    mesh.face_layers.iter_mut().for_each(|layer| layer.values.push(layer.values[face]));
}

/// Gives a face the labels and the numbers of another.
pub fn copy_face_values(mesh: &mut Mesh, from: FaceId, to: FaceId) {
    let (from, to) = (from.index(), to.index());
    label_arrays(mesh).for_each(|labels| labels[to] = labels[from]);
    mesh.face_layers.iter_mut().for_each(|layer| layer.values[to] = layer.values[from]);
}

/// Copies wedges that several vertices use, so that each vertex has its own; returns the number of
/// copies. The first vertex in the order of faces keeps the original.
pub fn own_wedges(mesh: &mut Mesh) -> usize {
    let Some(attributes) = &mut mesh.attributes else { return 0 };
    let before = attributes.wedge_count;
    let mut owner: Vec<Option<VertexId>> = vec![None; before];
    let mut others: FxHashMap<(WedgeId, VertexId), WedgeId> = FxHashMap::default();
    let mut copied: Vec<WedgeId> = Vec::new();
    let faces = mesh.faces.as_flattened().iter();
    for (wedge, &vertex) in attributes.corners.as_flattened_mut().iter_mut().zip(faces) {
        if *owner[wedge.index()].get_or_insert(vertex) != vertex {
            *wedge = *others.entry((*wedge, vertex)).or_insert_with(|| {
                copied.push(*wedge);
                WedgeId::new(before + copied.len() - 1)
            });
        }
    }
    for layer in &mut attributes.layers {
        for wedge in &copied {
            let start = wedge.index() * layer.width;
            layer.values.extend_from_within(start..start + layer.width);
        }
    }
    attributes.wedge_count += copied.len();
    copied.len()
}

/// Removes vertices and wedges that no face uses; returns the number of vertices removed.
pub fn drop_unused(mesh: &mut Mesh) -> usize {
    let before = mesh.positions.len();
    mesh.compact();
    before - mesh.positions.len()
}
