//! Skinning weights after rounding.

use meshlod_mesh::{Attributes, LayerKind, Mesh, WedgeId};

/// Largest change of a weight by rounding, by default.
const ROUNDING: f32 = 1.0 / 512.0;

/// Mends what rounding does to skinning weights: a sum that was one is one again, and a joint whose
/// weight has become 0 is joint 0, as glTF wants it.
pub(super) fn mend_weights(mesh: &mut Mesh) {
    let Some(Attributes { wedge_count, layers, .. }) = &mut mesh.attributes else { return };
    let of_kind = |kind: fn(u8) -> LayerKind| {
        let at = |set| layers.iter().position(|layer| layer.kind == kind(set));
        (0..=u8::MAX).map_while(at).collect::<Vec<usize>>()
    };
    let (joints, weights) = (of_kind(LayerKind::Joints), of_kind(LayerKind::Weights));
    let most_off = ROUNDING * (4 * weights.len()) as f32;
    for wedge in (0..*wedge_count).map(WedgeId::new) {
        let sum: f32 = weights.iter().flat_map(|&at| layers[at].of(wedge)).sum();
        let factor = if (sum - 1.0).abs() <= most_off { 1.0 / sum } else { 1.0 };
        for (set, &at) in weights.iter().enumerate() {
            layers[at].of_mut(wedge).iter_mut().for_each(|weight| *weight *= factor);
            let is_zero: [bool; 4] = std::array::from_fn(|k| layers[at].of(wedge)[k] == 0.0);
            let Some(&joints) = joints.get(set) else { continue };
            let pairs = layers[joints].of_mut(wedge).iter_mut().zip(is_zero);
            pairs.filter(|(_, is_zero)| *is_zero).for_each(|(joint, _)| *joint = 0.0);
        }
    }
}
