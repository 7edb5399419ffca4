//! Vector arithmetic in a fixed order of operations, since files depend on the last bits.

use glam::DVec3;

/// Returns the sum of products of coordinates, in the order of the axes.
#[inline]
pub(super) fn dot(a: DVec3, b: DVec3) -> f64 {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// Returns the cross product.
#[inline]
pub(super) fn cross(a: DVec3, b: DVec3) -> DVec3 {
    DVec3::new(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x)
}

#[inline]
pub(super) fn length(a: DVec3) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use meshlod_mesh::octahedral::{project, unfold};

    /// docs/formats/mlod.md says in which order directions are decoded and projected.
    #[test]
    fn directions_are_computed_as_the_format_says() {
        let n = 511.0;
        for code in (0..512 * 512).step_by(7) {
            let at = [code % 512, code / 512];
            let [x, y] = at.map(|x| f64::from(x) / n * 2.0 - 1.0);
            let z = 1.0 - x.abs() - y.abs();
            let over = if z < 0.0 { -z } else { 0.0 };
            let own = DVec3::new(x - over.copysign(x), y - over.copysign(y), z);
            let own = (1.0 / length(own)) * own;
            let unfolded = unfold(at, 9);
            assert_eq!(unfolded.to_array().map(f64::to_bits), own.to_array().map(f64::to_bits));
            let sum = own.x.abs() + own.y.abs() + own.z.abs();
            let DVec3 { x, y, z } = own / sum;
            let flat = match z >= 0.0 {
                true => [x, y],
                false => [(1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y)],
            };
            let flat = flat.map(|x| (x + 1.0) / 2.0 * n);
            assert_eq!(project(unfolded, 9).map(f64::to_bits), flat.map(f64::to_bits));
        }
    }
}
