//! Edits of a mesh together with its attributes and labels.

use meshlod_mesh::{Mesh, VertexId, WedgeId};
use rustc_hash::FxHashMap;

/// Removes the faces for which `keeps` is false, with their corners and labels; returns their
/// number.
pub fn retain_faces(mesh: &mut Mesh, keeps: impl Fn(usize) -> bool) -> usize {
    let before = mesh.faces.len();
    if (0..before).all(&keeps) {
        return 0;
    }
    retain(&mut mesh.faces, &keeps);
    if let Some(attributes) = &mut mesh.attributes {
        retain(&mut attributes.corners, &keeps);
    }
    for values in face_values(mesh) {
        retain(values, &keeps);
    }
    before - mesh.faces.len()
}

fn retain<T>(items: &mut Vec<T>, keeps: impl Fn(usize) -> bool) {
    let mut index = 0;
    items.retain(|_| {
        index += 1;
        keeps(index - 1)
    });
}

/// Iterates over what the faces of a mesh have one number of each: labels of their material and
/// object, and smoothing groups.
pub fn face_values(mesh: &mut Mesh) -> impl Iterator<Item = &mut Vec<u32>> {
    let labels = mesh.materials.iter_mut().chain(&mut mesh.objects);
    labels.map(|labels| &mut labels.of_face).chain(&mut mesh.smoothing)
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
