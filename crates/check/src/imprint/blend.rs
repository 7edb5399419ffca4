//! Wedges of new vertices.

use meshlod_mesh::{Attributes, LayerKind, WedgeId};

/// A new wedge between those of a face, by their parts.
pub fn blend(attributes: &mut Attributes, corners: [WedgeId; 3], parts: [f64; 3]) -> WedgeId {
    let nearest = (0..3).max_by(|&i, &j| parts[i].total_cmp(&parts[j])).expect("three parts");
    for layer in &mut attributes.layers {
        let mut values = layer.of(corners[nearest]).to_vec();
        // Weights are those of the joints beside them.
        if !matches!(layer.kind, LayerKind::Joints(_) | LayerKind::Weights(_)) {
            // The hand of a tangent is not blended.
            let width = if layer.kind == LayerKind::Tangent { 3 } else { layer.width };
            for (k, value) in values.iter_mut().enumerate().take(width) {
                let part = |i: usize| parts[i] * f64::from(layer.of(corners[i])[k]);
                *value = (part(0) + part(1) + part(2)) as f32;
            }
        }
        if matches!(layer.kind, LayerKind::Normal | LayerKind::Tangent) {
            to_unit_length(&mut values[..3]);
        }
        layer.values.extend(values);
    }
    attributes.wedge_count += 1;
    WedgeId::new(attributes.wedge_count - 1)
}

/// Makes a direction of values, unless they are all 0.
pub fn to_unit_length(values: &mut [f32]) {
    let length = values.iter().map(|x| x * x).sum::<f32>().sqrt();
    if length > 0.0 {
        values.iter_mut().for_each(|x| *x /= length);
    }
}
