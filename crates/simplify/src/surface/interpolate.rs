//! Interpolation of attribute values at a point of a face, by the rule of each layer.

use glam::DVec3;
use meshlod_mesh::{Layer, LayerKind, WedgeId};
use meshlod_spatial::Triangle;

/// A layer of values that are looked up by wedge.
pub(crate) trait LayerValues {
    fn kind(&self) -> LayerKind;
    fn width(&self) -> usize;
    fn of(&self, wedge: WedgeId) -> &[f32];
}

impl LayerValues for Layer {
    fn kind(&self) -> LayerKind {
        self.kind
    }

    fn width(&self) -> usize {
        self.width
    }

    fn of(&self, wedge: WedgeId) -> &[f32] {
        self.of(wedge)
    }
}

/// Point in a face, given by the wedges at its corners and barycentric weights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Place {
    pub(crate) wedges: [WedgeId; 3],
    /// Barycentric weights: non-negative, with sum one.
    pub(crate) shares: [f64; 3],
}

impl Place {
    /// Returns the corner with the greatest weight, the first of equals.
    fn nearest(&self) -> usize {
        (1..3).fold(0, |most, k| if self.shares[k] > self.shares[most] { k } else { most })
    }

    /// Returns the corner at which the point is, if any.
    fn corner(&self) -> Option<usize> {
        self.shares.iter().position(|&share| share == 1.0)
    }

    /// Interpolates value `i` of a layer linearly.
    #[inline]
    fn mean(&self, layer: &impl LayerValues, i: usize) -> f64 {
        // A value of zero weight may be infinite.
        let of = |k: usize| self.shares[k] * f64::from(layer.of(self.wedges[k])[i]);
        (0..3).filter(|&k| self.shares[k] > 0.0).map(of).sum()
    }
}

/// Returns the barycentric weights of a point in a triangle; for a point at a corner, exactly 1 for
/// that corner and 0 for the others.
///
/// Computed from areas, or along the longest edge if the triangle has no area.
pub(crate) fn shares(point: DVec3, triangle: &Triangle) -> [f64; 3] {
    if let Some(k) = triangle.iter().position(|&corner| corner == point) {
        return std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
    }
    let [a, b, c] = triangle.map(|corner| corner - point);
    let (bc, ca, ab) = (b.cross(c), c.cross(a), a.cross(b));
    let normal = bc + ca + ab;
    let areas = [bc, ca, ab].map(|part| part.dot(normal).max(0.0));
    let sum: f64 = areas.iter().sum();
    if sum > f64::MIN_POSITIVE {
        areas.map(|area| area / sum)
    } else {
        along_longest(point, triangle)
    }
}

fn along_longest(point: DVec3, triangle: &Triangle) -> [f64; 3] {
    let squared = |k: usize| triangle[k].distance_squared(triangle[(k + 1) % 3]);
    let k = (1..3).fold(0, |longest, k| if squared(k) > squared(longest) { k } else { longest });
    let along = triangle[(k + 1) % 3] - triangle[k];
    let t = (point - triangle[k]).dot(along) / along.length_squared();
    let mut shares = [0.0; 3];
    shares[(k + 1) % 3] = if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.0 };
    shares[k] = 1.0 - shares[(k + 1) % 3];
    shares
}

/// Appends the values of all layers at a point, layer by layer. At a corner they are exactly the
/// corner's values.
pub(crate) fn interpolate(layers: &[impl LayerValues], place: &Place, out: &mut Vec<f32>) {
    if let Some(k) = place.corner() {
        out.extend(layers.iter().flat_map(|layer| layer.of(place.wedges[k])));
        return;
    }
    let start = out.len();
    for layer in layers {
        let linear = |i| place.mean(layer, i) as f32;
        let nearest = layer.of(place.wedges[place.nearest()]);
        match layer.kind() {
            LayerKind::Normal | LayerKind::Tangent => direction(layer, place, nearest, out),
            // Written below, together with their weights.
            LayerKind::Joints(_) => out.extend_from_slice(nearest),
            LayerKind::Label => out.extend_from_slice(majority(layer, place)),
            _ => out.extend((0..layer.width()).map(linear)),
        }
    }
    if layers.iter().any(|layer| matches!(layer.kind(), LayerKind::Joints(_))) {
        skin(layers, place, &mut out[start..]);
    }
}

/// Returns the values that corners of the greatest total weight have, those of the nearest corner
/// among equals.
fn majority<'l>(layer: &'l impl LayerValues, place: &Place) -> &'l [f32] {
    let values = place.wedges.map(|wedge| layer.of(wedge));
    let weight = |of: usize| -> f64 {
        (0..3).filter(|&k| values[k] == values[of]).map(|k| place.shares[k]).sum()
    };
    let nearest = place.nearest();
    let most = [0, 1, 2].into_iter().fold(nearest, |most, k| {
        // Sums in another order may differ in their last bit.
        if weight(k) > weight(most) + 1e-12 { k } else { most }
    });
    values[most]
}

/// Writes a unit vector, or the nearest corner's where the three cancel. Components beyond the
/// third, such as the handedness of a tangent, cannot be averaged and stay the nearest corner's.
fn direction(layer: &impl LayerValues, place: &Place, nearest: &[f32], out: &mut Vec<f32>) {
    let start = out.len();
    out.extend_from_slice(nearest);
    let sum = DVec3::from([0, 1, 2].map(|i| place.mean(layer, i)));
    if let Some(unit) = sum.try_normalize() {
        let unit = unit.to_array();
        out[start..].iter_mut().zip(unit).for_each(|(value, x)| *value = x as f32);
    }
}

/// Joint and its weight.
type Influence = (f32, f64);

/// Interpolates skinning influences. Joints are names and never averaged: the influences of the
/// corners are combined, and the strongest that fit are kept and scaled to the original total.
fn skin(layers: &[impl LayerValues], place: &Place, out: &mut [f32]) {
    let mut influences: Vec<Influence> = Vec::with_capacity(24);
    let mut all = 0.0;
    for (joints, weights) in sets(layers) {
        for (wedge, share) in place.wedges.iter().zip(place.shares) {
            let of = |at: &Range| layers[at.layer].of(*wedge);
            for (&joint, &weight) in of(&joints).iter().zip(of(&weights)) {
                let weight = share * f64::from(weight);
                if weight > 0.0 {
                    all += weight;
                    add(&mut influences, (joint, weight));
                }
            }
        }
    }
    // Ties are ordered by name, so that the order of corners has no effect.
    influences.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.total_cmp(&b.0)));
    influences.truncate(sets(layers).map(|(joints, weights)| joints.shared(&weights)).sum());
    let kept: f64 = influences.iter().map(|(_, weight)| weight).sum();
    let mut next = influences.iter().map(|&(joint, weight)| (joint, weight * (all / kept)));
    for (joints, weights) in sets(layers) {
        for i in 0..joints.shared(&weights) {
            let (joint, weight) = next.next().unwrap_or((0.0, 0.0));
            out[joints.start + i] = joint;
            out[weights.start + i] = weight as f32;
        }
    }
}

fn add(influences: &mut Vec<Influence>, (joint, weight): Influence) {
    match influences.iter_mut().find(|(other, _)| *other == joint) {
        Some((_, sum)) => *sum += weight,
        None => influences.push((joint, weight)),
    }
}

/// Range of a layer's values among those of a wedge.
struct Range {
    layer: usize,
    start: usize,
    width: usize,
}

impl Range {
    fn shared(&self, other: &Self) -> usize {
        self.width.min(other.width)
    }
}

/// Pairs each layer of joints with the layer of weights of the same number; together they form one
/// list of influences.
fn sets(layers: &[impl LayerValues]) -> impl Iterator<Item = (Range, Range)> + '_ {
    let range = |layer: usize| {
        let start = layers[..layer].iter().map(|before| before.width()).sum();
        Range { layer, start, width: layers[layer].width() }
    };
    layers.iter().enumerate().filter_map(move |(i, joints)| {
        let LayerKind::Joints(number) = joints.kind() else { return None };
        let weights = layers.iter().position(|l| l.kind() == LayerKind::Weights(number))?;
        Some((range(i), range(weights)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACE: Place =
        Place { wedges: [WedgeId(0), WedgeId(1), WedgeId(2)], shares: [0.5, 0.25, 0.25] };

    fn layer(kind: LayerKind, width: usize, values: &[f32]) -> Layer {
        Layer { kind, name: String::new(), width, values: values.to_vec() }
    }

    fn values(layers: &[Layer], place: &Place) -> Vec<f32> {
        let mut out = Vec::new();
        interpolate(layers, place, &mut out);
        out
    }

    #[test]
    fn shares_find_the_point_again() {
        let triangle = [DVec3::ZERO, DVec3::X * 4.0, DVec3::new(0.0, 2.0, 1.0)];
        for expected in [[0.5, 0.25, 0.25], [0.0, 0.5, 0.5], [0.0, 0.0, 1.0]] {
            let point = (0..3).map(|k| triangle[k] * expected[k]).sum();
            assert_eq!(shares(point, &triangle), expected);
        }
    }

    #[test]
    fn labels_are_those_of_the_majority() {
        let at = |shares| Place { shares, ..PLACE };
        let labels = layer(LayerKind::Label, 2, &[3.0, 1.0, 7.0, 1.0, 7.0, 1.0]);
        let of = |shares| values(std::slice::from_ref(&labels), &at(shares));
        assert_eq!(of([0.4, 0.3, 0.3]), [7.0, 1.0]);
        assert_eq!(of([0.5, 0.25, 0.25]), [3.0, 1.0], "the nearest corner wins a tie");
        assert_eq!(of([0.6, 0.2, 0.2]), [3.0, 1.0]);
    }

    #[test]
    fn a_triangle_without_area_has_shares_along_it() {
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 4.0];
        assert_eq!(shares(DVec3::X * 3.0, &line), [0.25, 0.0, 0.75]);
        assert_eq!(shares(DVec3::Y, &[DVec3::ZERO; 3]).iter().sum::<f64>(), 1.0);
    }

    #[test]
    fn a_corner_keeps_its_values_to_the_bit() {
        let joints = layer(LayerKind::Joints(0), 1, &[7.0, 8.0, 9.0]);
        let odd = layer(LayerKind::Normal, 3, &[9.0; 9]);
        let other = layer(LayerKind::Other, 1, &[f32::INFINITY, 0.1, f32::NAN]);
        let place = Place { shares: [0.0, 1.0, 0.0], ..PLACE };
        assert_eq!(values(&[joints, odd, other], &place), [8.0, 9.0, 9.0, 9.0, 0.1]);
    }

    #[test]
    fn directions_keep_their_length_and_hands() {
        let normals = [1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0];
        let tangent = layer(LayerKind::Tangent, 4, &normals);
        let found = values(&[tangent], &PLACE);
        let half = 0.5f32.sqrt();
        assert!((found[0] - half).abs() < 1e-6 && (found[1] - half).abs() < 1e-6);
        assert_eq!(found[2..], [0.0, 1.0]);
        let opposite = layer(LayerKind::Normal, 3, &[1., 0., 0., -1., 0., 0., -1., 0., 0.]);
        assert_eq!(values(&[opposite], &PLACE), [1.0, 0.0, 0.0]);
    }

    #[test]
    fn joints_are_put_together_by_name_and_the_strongest_stay() {
        let joints = layer(LayerKind::Joints(0), 2, &[3.0, 5.0, 5.0, 9.0, 9.0, 9.0]);
        let weights = layer(LayerKind::Weights(0), 2, &[0.75, 0.25, 0.5, 0.5, 1.0, 0.0]);
        // 3: 0.375; 5: 0.125 + 0.125; 9: 0.125 + 0.25. Equal weights are ordered by name.
        let found = values(&[joints, weights], &PLACE);
        assert_eq!(found, [3.0, 9.0, 0.5, 0.5]);
    }

    #[test]
    fn sets_of_influences_share_their_room() {
        let one = |kind, values: &[f32]| layer(kind, 1, values);
        let found = values(
            &[
                one(LayerKind::Joints(0), &[1.0, 2.0, 2.0]),
                one(LayerKind::Joints(1), &[2.0, 3.0, 3.0]),
                one(LayerKind::Weights(1), &[0.25, 0.25, 0.25]),
                one(LayerKind::Weights(0), &[0.75, 0.75, 0.75]),
            ],
            &PLACE,
        );
        // 2 has 0.125 + 0.375 and 1 has 0.375. 3 has 0.125 and does not fit; the rest is scaled to
        // one.
        assert_eq!(found[..2], [2.0, 1.0]);
        assert!((found[2] - 3.0 / 7.0).abs() < 1e-6 && (found[3] - 4.0 / 7.0).abs() < 1e-6);
    }

    #[test]
    fn influences_of_nothing_stay_nothing() {
        let joints = layer(LayerKind::Joints(0), 2, &[3.0; 6]);
        let weights = layer(LayerKind::Weights(0), 2, &[0.0; 6]);
        assert_eq!(values(&[joints, weights], &PLACE), [0.0; 4]);
    }
}
