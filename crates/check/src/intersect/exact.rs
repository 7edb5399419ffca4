//! Exact geometric predicates for points, lines and planes.
//!
//! `robust` computes the signs of determinants of `f64` coordinates without error as long as no
//! product overflows or underflows. [`super::ScaledPositions`] keeps coordinates in that range.

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Returns on which side of a triangle's plane `p` lies: positive if it sees the corners
/// counter-clockwise, 0 in the plane. The sign is exact, the magnitude about six times the volume
/// between.
#[inline]
pub(crate) fn side(&[a, b, c]: &[DVec3; 3], p: DVec3) -> f64 {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    -orient3d(coord(a), coord(b), coord(c), coord(p))
}

/// Returns the orientation of `p` to the line from `a` to `b`: positive on the left, 0 on the line.
/// The sign is exact.
#[inline]
pub(crate) fn orientation(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(p))
}

/// Projects a point along a coordinate axis. Triangles that are counter-clockwise seen from the
/// positive end of the axis stay counter-clockwise.
#[inline]
pub(crate) fn project(axis: usize, p: DVec3) -> DVec2 {
    match axis {
        0 => DVec2::new(p.y, p.z),
        1 => DVec2::new(p.z, p.x),
        _ => DVec2::new(p.x, p.y),
    }
}

/// Returns the axis along which the projected triangle is largest, and its orientation there;
/// `None` for a triangle of zero area.
pub(crate) fn projection_axis(triangle: &[DVec3; 3]) -> Option<(usize, f64)> {
    let areas = [0, 1, 2].map(|axis| {
        let [a, b, c] = triangle.map(|p| project(axis, p));
        orientation(a, b, c)
    });
    let widest = (0..3).max_by(|&i, &j| areas[i].abs().total_cmp(&areas[j].abs()))?;
    (areas[widest] != 0.0).then_some((widest, areas[widest]))
}
