//! Normals in four bytes, as points of the unfolded octahedron.

use glam::{Vec2, Vec3};
use meshlod::mesh::Layer;

/// Packs the normals of a layer, in 16-bit fractions from -1 to 1.
pub(super) fn fold(layer: &Layer) -> Vec<[i16; 2]> {
    layer.values.chunks_exact(3).map(|n| folded(Vec3::new(n[0], n[1], n[2]))).collect()
}

/// Code of a normal that is zero or not finite: the face is shaded flat there.
const NONE: [i16; 2] = [-i16::MAX; 2];

fn folded(normal: Vec3) -> [i16; 2] {
    if normal.try_normalize().is_none() {
        return NONE;
    }
    let [x, y, z] = (normal / normal.abs().element_sum().max(f32::MIN_POSITIVE)).to_array();
    let at = Vec2::new(x, y);
    let over = Vec2::new((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y));
    let at = if z >= 0.0 { at } else { over };
    let code = at.to_array().map(|x| (x * f32::from(i16::MAX)).round() as i16);
    // All four corners are -z; this one is taken.
    if code == [-i16::MAX; 2] { [i16::MAX; 2] } else { code }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_come_back() {
        for p in meshlod::samples::sphere(500).positions {
            let normal = Vec3::from(p.map(|x| x as f32)).normalize();
            let [x, y] = folded(normal).map(|x| f32::from(x) / f32::from(i16::MAX));
            let z = 1.0 - x.abs() - y.abs();
            let over = (-z).max(0.0);
            let back = Vec3::new(x - over.copysign(x), y - over.copysign(y), z).normalize();
            assert!(back.angle_between(normal) < 1e-3);
            assert_ne!(folded(normal), NONE);
        }
        assert_eq!(folded(Vec3::new(-0.0, -0.0, -1.0)), [i16::MAX; 2]);
        for broken in [Vec3::ZERO, Vec3::NAN, Vec3::INFINITY] {
            assert_eq!(folded(broken), NONE);
        }
    }
}
