//! Pairs of triangles that are apart beyond doubt, in `f64`.

use glam::DVec3;

use super::meet::Triangle;

/// Whether a plane, of one of the two, has the other on one side, by more than rounding can be.
///
/// `false` says nothing.
#[inline]
pub(super) fn surely_apart(a: &Triangle, b: &Triangle) -> bool {
    beyond_plane(a, b) || beyond_plane(b, a)
}

/// Whether all corners of `b` are surely on one side of the plane of `a`.
#[inline]
fn beyond_plane(a: &Triangle, b: &Triangle) -> bool {
    let (u, v) = (a[1] - a[0], a[2] - a[0]);
    let normal = u.cross(v);
    let to = b.map(|p| p - a[0]);
    let heights = to.map(|p| p.dot(normal));
    let far = to.map(DVec3::abs).into_iter().fold(DVec3::ZERO, DVec3::max).max_element();
    let doubt = DOUBT * u.abs().max_element() * v.abs().max_element() * far + TINY;
    let least = heights[0].min(heights[1]).min(heights[2]);
    let greatest = heights[0].max(heights[1]).max(heights[2]);
    least > doubt || greatest < -doubt
}

/// The rounding of a height is at most 7 × 2^-53 of the sum of the six products in it [She97, section 4.3],
/// each of these at most the product of the largest components; 64 instead of 42, for rounding this
/// too.
const DOUBT: f64 = 64.0 / (1u64 << 53) as f64;
/// Heights below this may have lost digits to underflow.
const TINY: f64 = 1e-290;
