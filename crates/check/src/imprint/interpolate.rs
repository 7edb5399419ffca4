//! Interpolation of attribute values for new vertices on cut faces.

use meshlod_mesh::{Attributes, LayerKind, WedgeId};

/// Appends a wedge whose values are interpolated from the wedges of a face by barycentric weights.
pub fn interpolate_wedge(
    attributes: &mut Attributes,
    corners: [WedgeId; 3],
    weights: [f64; 3],
) -> WedgeId {
    let nearest = (0..3).max_by(|&i, &j| weights[i].total_cmp(&weights[j])).expect("three weights");
    for layer in &mut attributes.layers {
        let mut values = layer.of(corners[nearest]).to_vec();
        // Joints, their weights and labels are those of the nearest corner.
        if layer.kind.is_blended() {
            // The handedness of a tangent is not interpolated.
            let width = if layer.kind == LayerKind::Tangent { 3 } else { layer.width };
            for (k, value) in values.iter_mut().enumerate().take(width) {
                let term = |i: usize| weights[i] * f64::from(layer.of(corners[i])[k]);
                *value = (term(0) + term(1) + term(2)) as f32;
            }
        }
        if matches!(layer.kind, LayerKind::Normal | LayerKind::Tangent) {
            normalize(&mut values[..3]);
        }
        layer.values.extend(values);
    }
    attributes.wedge_count += 1;
    WedgeId::new(attributes.wedge_count - 1)
}

/// Scales a vector to length 1, unless it is zero.
pub fn normalize(values: &mut [f32]) {
    let length = values.iter().map(|x| x * x).sum::<f32>().sqrt();
    if length > 0.0 {
        values.iter_mut().for_each(|x| *x /= length);
    }
}
