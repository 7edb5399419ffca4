//! Repairs attributes and labels that do not match the faces.

use meshlod_mesh::{Attributes, Labels, Mesh};

use super::edit::own_wedges;

/// Removes mismatched attributes and labels, and splits wedges used by several vertices; returns
/// the number of repairs.
///
/// All attributes are removed if the corners do not match the faces, else only mismatched layers.
pub fn repair(mesh: &mut Mesh) -> usize {
    let faces = mesh.faces.len();
    let mut count = 0;
    if mesh.attributes.as_ref().is_some_and(|attributes| !corners_fit(attributes, faces)) {
        mesh.attributes = None;
        count += 1;
    }
    if let Some(attributes) = &mut mesh.attributes {
        count += drop_bad_layers(attributes);
    }
    for labels in [&mut mesh.materials, &mut mesh.objects] {
        if labels.as_ref().is_some_and(|labels| !labels_fit(labels, faces)) {
            *labels = None;
            count += 1;
        }
    }
    let layers = mesh.face_layers.len();
    mesh.face_layers.retain(|layer| layer.values.len() == faces);
    count + layers - mesh.face_layers.len() + own_wedges(mesh)
}

fn corners_fit(attributes: &Attributes, faces: usize) -> bool {
    attributes.corners.len() == faces
        && attributes.corners.as_flattened().iter().all(|w| w.index() < attributes.wedge_count)
}

fn drop_bad_layers(attributes: &mut Attributes) -> usize {
    let (count, before) = (attributes.wedge_count, attributes.layers.len());
    attributes.layers.retain(|layer| {
        Some(layer.values.len()) == count.checked_mul(layer.width)
            && layer.kind.width().is_none_or(|width| width == layer.width)
    });
    if attributes.layers.iter().all(|layer| layer.values.is_empty()) {
        // No layer determines the number of wedges, so the corners do.
        let named = attributes.corners.as_flattened().iter().max();
        attributes.wedge_count = named.map_or(0, |w| w.index() + 1);
    }
    before - attributes.layers.len()
}

fn labels_fit(labels: &Labels, faces: usize) -> bool {
    let count = labels.names.len();
    labels.of_face.len() == faces && labels.of_face.iter().all(|&label| (label as usize) < count)
}
