//! Joints and their weights; in glTF, the weights of a vertex sum to 1.

use meshlod_mesh::{Layer, LayerKind, WedgeId};

use super::Scene;
use crate::notes::Note;

/// Number formats of weights that are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Weights {
    Floats,
    /// Multiples of 1/255 that sum to 1.
    Bytes,
}

/// Largest rounding error of a sum of 32-bit weights.
const ROUNDING: f64 = 1e-7;

/// Largest rounding error of a sum of byte weights.
const ROUNDING_OF_BYTES: f64 = 1e-2;

/// Components of joints and weights.
const WIDTH: usize = 4;

/// Notes the number of vertices whose joint weights do not sum to 1. Renderers differ in their
/// treatment, so unchanged meshes keep them; see [`normalize`].
///
/// Cost: linear in the weights.
pub(crate) fn note_sums(scene: &mut Scene) {
    let mut off = 0;
    for attributes in scene.meshes.iter().filter_map(|mesh| mesh.mesh.attributes.as_ref()) {
        let is_weights = |layer: &&Layer| matches!(layer.kind, LayerKind::Weights(_));
        let layers: Vec<&Layer> = attributes.layers.iter().filter(is_weights).collect();
        let count = if layers.is_empty() { 0 } else { attributes.wedge_count };
        let sum = |wedge: usize| -> f64 {
            let weights = layers.iter().flat_map(|layer| layer.of(WedgeId::new(wedge)));
            weights.map(|&weight| f64::from(weight.max(0.0))).sum()
        };
        let is_off = |&sum: &f64| sum > 0.0 && (sum - 1.0).abs() > ROUNDING_OF_BYTES;
        off += (0..count).map(sum).filter(is_off).count();
    }
    if off > 0 {
        scene.notes.push(Note::changed(
            off,
            "vertex whose joint weights do not sum to 1, scaled where its mesh is written anew",
            "vertices whose joint weights do not sum to 1, scaled where their mesh is written anew",
        ));
    }
}

/// Scales the weights of each vertex, over all its sets, to the sum 1, and sets joints without
/// weight to 0. Vertices without positive weights stay unchanged.
///
/// `values` has the values of each layer, of these kinds, at all vertices.
pub(crate) fn normalize(kinds: &[LayerKind], values: &mut [Vec<f32>], how: Weights) {
    let sets = sets(kinds);
    let count = sets.first().map_or(0, |&(first, _)| values[first].len() / WIDTH);
    let mut weights = Vec::new();
    for range in (0..count).map(|vertex| vertex * WIDTH..(vertex + 1) * WIDTH) {
        weights.clear();
        for &(set, _) in &sets {
            weights.extend(values[set][range.clone()].iter().map(|&w| f64::from(w.max(0.0))));
        }
        let sum: f64 = weights.iter().sum();
        if sum <= 0.0 || !sum.is_finite() {
            continue;
        }
        match how {
            Weights::Bytes => share_bytes(&mut weights, sum),
            Weights::Floats if (sum - 1.0).abs() <= ROUNDING => {}
            Weights::Floats => weights.iter_mut().for_each(|weight| *weight /= sum),
        }
        for (&(set, joints), weights) in sets.iter().zip(weights.chunks_exact(WIDTH)) {
            for (at, &weight) in range.clone().zip(weights) {
                let weight = weight as f32;
                values[set][at] = weight;
                if let Some(joints) = joints.filter(|_| weight == 0.0) {
                    values[joints][at] = 0.0;
                }
            }
        }
    }
}

/// Pairs each layer of weights with its layer of joints, if any.
fn sets(kinds: &[LayerKind]) -> Vec<(usize, Option<usize>)> {
    let find = |kind| kinds.iter().position(|&other| other == kind);
    let set = |(at, &kind)| match kind {
        LayerKind::Weights(set) => Some((at, find(LayerKind::Joints(set)))),
        _ => None,
    };
    kinds.iter().enumerate().filter_map(set).collect()
}

/// Rounds weights to multiples of 1/255 that sum to 1, by the largest remainder method.
fn share_bytes(weights: &mut [f64], sum: f64) {
    let exact: Vec<f64> = weights.iter().map(|weight| weight / sum * 255.0).collect();
    let mut bytes: Vec<f64> = exact.iter().map(|x| x.floor()).collect();
    let left = 255.0 - bytes.iter().sum::<f64>();
    let mut order: Vec<usize> = (0..bytes.len()).filter(|&i| exact[i] > 0.0).collect();
    let lost = |i: usize| exact[i] - exact[i].floor();
    order.sort_by(|&a, &b| lost(b).total_cmp(&lost(a)).then(a.cmp(&b)));
    for &i in order.iter().cycle().take(left.max(0.0) as usize) {
        bytes[i] += 1.0;
    }
    for (weight, byte) in weights.iter_mut().zip(bytes) {
        *weight = byte / 255.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normalises the weights of one vertex with two sets; returns its joints and weights.
    fn normalized(weights: [f32; 8], how: Weights) -> ([f32; 8], [f32; 8]) {
        let kinds = [
            LayerKind::Weights(1),
            LayerKind::Joints(0),
            LayerKind::Weights(0),
            LayerKind::Joints(1),
        ];
        let (low, high) = weights.split_at(4);
        let mut values =
            [high.to_vec(), vec![1.0, 2.0, 3.0, 4.0], low.to_vec(), vec![5.0, 6.0, 7.0, 8.0]];
        normalize(&kinds, &mut values, how);
        let [high, joints, low, more] = values;
        let eight = |a: Vec<f32>, b: Vec<f32>| [a, b].concat().try_into().unwrap();
        (eight(joints, more), eight(low, high))
    }

    #[test]
    fn weights_of_all_sets_sum_to_one_and_unused_joints_are_zero() {
        let (joints, weights) =
            normalized([0.5, 0.0, 0.25, -0.1, 0.0, 0.0, 0.5, 0.0], Weights::Floats);
        assert_eq!(joints, [1.0, 0.0, 3.0, 0.0, 0.0, 0.0, 7.0, 0.0]);
        assert_eq!(weights, [0.4, 0.0, 0.2, 0.0, 0.0, 0.0, 0.4, 0.0]);
    }

    #[test]
    fn weights_within_rounding_stay_and_vertices_without_any_too() {
        let third = 1.0 / 3.0;
        let rounded = [third, third, third, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(normalized(rounded, Weights::Floats).1, rounded);
        for how in [Weights::Floats, Weights::Bytes] {
            let (joints, weights) = normalized([0.0; 8], how);
            assert_eq!((joints[7], weights), (8.0, [0.0; 8]));
        }
    }

    #[test]
    fn bytes_sum_to_255_and_are_off_by_less_than_one() {
        for weights in [
            [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.125; 8],
            [0.9991, 0.0003, 0.0003, 0.0003, 0.0, 0.0, 0.0, 0.0],
            [3e-3, 2e-3, 1e-3, 0.0, 1e-30, 0.0, 0.0, 7e-3],
        ] {
            let sum: f32 = weights.iter().sum();
            let (_, found) = normalized(weights, Weights::Bytes);
            let bytes = found.map(|w| (w * 255.0).round());
            assert_eq!(bytes.iter().sum::<f32>(), 255.0);
            for (byte, weight) in bytes.iter().zip(weights) {
                assert!((byte - 255.0 * weight / sum).abs() < 1.0, "{bytes:?} of {weights:?}");
            }
        }
    }

    #[test]
    fn weights_that_do_not_sum_to_one_are_counted() {
        let mut mesh = meshlod_fixtures::cube();
        let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
        let mut values = [0.5, 0.5, 0.0, 0.0].repeat(8);
        (values[0], values[4], values[8], values[9]) = (0.75, 0.495, 0.0, 0.0);
        let kind = LayerKind::Weights(0);
        let layers = vec![Layer { kind, name: String::new(), width: WIDTH, values }];
        mesh.attributes = Some(meshlod_mesh::Attributes { corners, wedge_count: 8, layers });
        let mut scene = Scene::from_mesh("cube", mesh);
        note_sums(&mut scene);
        assert_eq!(scene.notes.len(), 1);
        assert_eq!(scene.notes[0].count, 1);
    }
}
