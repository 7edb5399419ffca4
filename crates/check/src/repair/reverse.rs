//! Reverses faces together with their normals and tangents.

use glam::DVec3;
use meshlod_mesh::{LayerKind, Mesh};

/// Reverses the orientation of the flagged faces.
///
/// Wedges stay with their corners. A normal may have been right all along: it is reversed only if
/// all faces at its wedge are reversed and it agreed with them before. The tangent there then
/// changes its handedness.
pub fn reverse_faces(mesh: &mut Mesh, reversed: &[bool]) {
    reverse_normals(mesh, reversed);
    let each = mesh.faces.iter_mut().zip(reversed);
    each.filter(|(_, reversed)| **reversed).for_each(|(face, _)| face.swap(1, 2));
    if let Some(attributes) = &mut mesh.attributes {
        let each = attributes.corners.iter_mut().zip(reversed);
        each.filter(|(_, reversed)| **reversed).for_each(|(corners, _)| corners.swap(1, 2));
    }
}

fn reverse_normals(mesh: &mut Mesh, reversed: &[bool]) {
    let mut layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
    if !layers.any(|layer| layer.kind == LayerKind::Normal) {
        return;
    }
    let agreed = agreement(mesh, reversed);
    let Some(attributes) = &mut mesh.attributes else { return };
    for layer in &mut attributes.layers {
        // The last value of a tangent is its handedness.
        let part = match layer.kind {
            LayerKind::Normal => 0..3,
            LayerKind::Tangent => 3..4,
            _ => continue,
        };
        for (value, _) in
            layer.values.chunks_exact_mut(layer.width).zip(&agreed).filter(|(_, a)| **a)
        {
            value[part.clone()].iter_mut().for_each(|x| *x = -*x);
        }
    }
}

/// Returns a flag per wedge: true if all its faces are reversed and its normal agreed with them.
fn agreement(mesh: &Mesh, reversed: &[bool]) -> Vec<bool> {
    let Some(attributes) = &mesh.attributes else { return Vec::new() };
    let Some(normals) = attributes.layer(LayerKind::Normal) else { return Vec::new() };
    let mut stays = vec![false; attributes.wedge_count];
    let mut along = vec![0.0; attributes.wedge_count];
    for ((&face, corners), &reversed) in mesh.faces.iter().zip(&attributes.corners).zip(reversed) {
        let [a, b, c] = mesh.triangle(face);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for &wedge in corners {
            stays[wedge.index()] |= !reversed;
            let own: [f64; 3] = std::array::from_fn(|i| f64::from(normals.of(wedge)[i]));
            along[wedge.index()] += normal.dot(DVec3::from(own));
        }
    }
    stays.iter().zip(&along).map(|(&stays, &along)| !stays && along > 0.0).collect()
}
