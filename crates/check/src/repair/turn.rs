//! Turning faces over, with what hangs on them.

use glam::DVec3;
use meshlod_mesh::{LayerKind, Mesh};

/// Turns the flagged faces over.
///
/// Wedges go with their corners. A normal, which may have been right all along, is turned with its
/// wedge only where all faces at the wedge are turned and it agreed with them before; then the
/// tangent there changes its hand.
pub fn turn(mesh: &mut Mesh, turned: &[bool]) {
    turn_normals(mesh, turned);
    let each = mesh.faces.iter_mut().zip(turned);
    each.filter(|(_, turned)| **turned).for_each(|(face, _)| face.swap(1, 2));
    if let Some(attributes) = &mut mesh.attributes {
        let each = attributes.corners.iter_mut().zip(turned);
        each.filter(|(_, turned)| **turned).for_each(|(corners, _)| corners.swap(1, 2));
    }
}

fn turn_normals(mesh: &mut Mesh, turned: &[bool]) {
    let normals = |mesh: &Mesh| {
        let layers = mesh.attributes.iter().flat_map(|attributes| &attributes.layers);
        layers.filter(|layer| layer.kind == LayerKind::Normal).count() > 0
    };
    if !normals(mesh) {
        return;
    }
    let agreed = agreement(mesh, turned);
    let Some(attributes) = &mut mesh.attributes else { return };
    for layer in &mut attributes.layers {
        // Of a tangent, the last value is the hand.
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

/// For every wedge, whether all faces at it are turned and its normal agreed with them.
fn agreement(mesh: &Mesh, turned: &[bool]) -> Vec<bool> {
    let Some(attributes) = &mesh.attributes else { return Vec::new() };
    let Some(normals) = attributes.layer(LayerKind::Normal) else { return Vec::new() };
    let mut stays = vec![false; attributes.wedge_count];
    let mut along = vec![0.0; attributes.wedge_count];
    for ((&face, corners), &turned) in mesh.faces.iter().zip(&attributes.corners).zip(turned) {
        let [a, b, c] = mesh.triangle(face);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for &wedge in corners {
            stays[wedge.index()] |= !turned;
            let own: [f64; 3] = std::array::from_fn(|i| f64::from(normals.of(wedge)[i]));
            along[wedge.index()] += normal.dot(DVec3::from(own));
        }
    }
    stays.iter().zip(&along).map(|(&stays, &along)| !stays && along > 0.0).collect()
}
