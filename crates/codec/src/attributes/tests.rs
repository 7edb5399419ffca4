use meshlod_samples as samples;

use super::*;

const KINDS: [(LayerKind, usize); 9] = [
    (LayerKind::Normal, 3),
    (LayerKind::Tangent, 4),
    (LayerKind::Uv(0), 2),
    (LayerKind::Uv(3), 2),
    (LayerKind::Color(0), 3),
    (LayerKind::Color(1), 4),
    (LayerKind::Joints(0), 4),
    (LayerKind::Weights(0), 4),
    (LayerKind::Other, 5),
];

/// Attribute values on a sphere: directions, or repeated coordinates.
fn layer(kind: LayerKind, width: usize, scale: f32) -> (Layer, Vec<WedgeId>) {
    let points = samples::sphere(2000).positions;
    let value = |p: &[f64; 3], k: usize| match kind {
        LayerKind::Joints(_) => (p[k % 3] * 100.0).abs().round() as f32,
        LayerKind::Normal | LayerKind::Tangent if k == 3 => (p[0] as f32).signum(),
        LayerKind::Normal | LayerKind::Tangent => p[k] as f32,
        _ => p[k % 3] as f32 * scale,
    };
    let values = points.iter().flat_map(|p| (0..width).map(move |k| value(p, k))).collect();
    let wedges = (0..points.len()).rev().map(WedgeId::new).collect();
    (Layer { kind, name: format!("{kind:?}"), width, values }, wedges)
}

fn rows(nodes: usize) -> Rows {
    Rows::new((0..nodes.div_ceil(32)).map(|row| 32.min(nodes - 32 * row)))
}

#[test]
fn every_kind_is_within_its_bound_and_comes_back_from_bytes() {
    let fine =
        AttributeBounds { direction_rad: 0.0002, uv: 1e-5, color: 1e-4, weight: 1e-4, other: 1e-5 };
    for bounds in [AttributeBounds::default(), fine] {
        for (kind, width) in KINDS {
            let (layer, wedges) = layer(kind, width, 1.0);
            let packed = PackedLayer::new(&layer, &wedges, rows(wedges.len()), &bounds);
            let report = packed.report();
            let bound = if matches!(kind, LayerKind::Joints(_)) {
                0.0
            } else {
                bounds.of(&layer, wedges.iter().copied())
            };
            assert!(report.max_error <= bound, "{report:?} {bound}");
            assert!(bound == 0.0 || report.max_error > bound / 8.0, "{report:?} {bound}");
            let mut bytes = Vec::new();
            packed.store(&mut bytes);
            assert_eq!(bytes.len(), report.bytes);
            let mut reader = Reader::new(&bytes);
            assert_eq!(PackedLayer::restore(rows(wedges.len()), &mut reader), Ok(packed));
            reader.finish().unwrap();
        }
    }
}

#[test]
fn eight_bits_of_colour_are_exact() {
    let values: Vec<f32> = (0..256).flat_map(|i| [i as f32 / 255.0; 3]).collect();
    let layer = Layer { kind: LayerKind::Color(0), name: String::new(), width: 3, values };
    let wedges: Vec<_> = (0..256).map(WedgeId::new).collect();
    let packed = PackedLayer::new(&layer, &wedges, rows(256), &AttributeBounds::default());
    let back = packed.decode().values;
    assert!(
        back.iter().zip(&layer.values).all(|(a, b)| (255.0 * a).round() == (255.0 * b).round())
    );
}

#[test]
fn values_of_any_size_are_as_close_as_f32_tells() {
    let bounds = AttributeBounds { uv: 0.0, other: 0.0, ..AttributeBounds::default() };
    for scale in [1e-44, 1e-30, 1.0, 1e30, f32::MAX / 2.0] {
        for kind in [LayerKind::Uv(0), LayerKind::Other] {
            let (layer, wedges) = layer(kind, kind.width().unwrap_or(5), scale);
            let packed = PackedLayer::new(&layer, &wedges, rows(wedges.len()), &bounds);
            let error = packed.report().max_error;
            assert!(error <= f64::from(scale) * 1.2e-7 + 1e-45, "{scale}: {error}");
        }
    }
}

#[test]
fn damaged_bytes_are_refused_or_decode_to_finite_values() {
    for (kind, width) in KINDS {
        let (layer, wedges) = layer(kind, width, 1.0);
        let wedges = &wedges[..200];
        let packed = PackedLayer::new(&layer, wedges, rows(200), &AttributeBounds::default());
        let mut bytes = Vec::new();
        packed.store(&mut bytes);
        for bit in (0..8 * bytes.len()).step_by(3) {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            if let Ok(packed) = PackedLayer::restore(rows(200), &mut Reader::new(&damaged)) {
                assert!(packed.decode().values.iter().all(|x| x.is_finite()));
            }
        }
    }
}
