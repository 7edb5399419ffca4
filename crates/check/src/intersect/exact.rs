//! Signs of determinants, exact.
//!
//! `robust` computes them from the `f64` coordinates without error, as long as no product over- or
//! underflows. [`super::Points`] keeps them far from both.

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D, orient2d, orient3d};

/// How `p` lies to the plane of a triangle: above 0 where it sees the corners counter-clockwise, 0
/// in the plane, exactly; about six times the volume between.
#[inline]
pub(crate) fn side(&[a, b, c]: &[DVec3; 3], p: DVec3) -> f64 {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    -orient3d(coord(a), coord(b), coord(c), coord(p))
}

/// How `p` lies to the line from `a` to `b`: above 0 on its left, 0 on it, exactly.
#[inline]
pub(crate) fn turn(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(p))
}

/// The point without one coordinate, so that what is counter-clockwise seen from that axis's
/// positive end stays so.
#[inline]
pub(crate) fn without(axis: usize, p: DVec3) -> DVec2 {
    match axis {
        0 => DVec2::new(p.y, p.z),
        1 => DVec2::new(p.z, p.x),
        _ => DVec2::new(p.x, p.y),
    }
}

/// An axis along which the triangle is not a line, and its turn seen along it; `None` where it has
/// no area.
pub(crate) fn open_axis(triangle: &[DVec3; 3]) -> Option<(usize, f64)> {
    let turns = [0, 1, 2].map(|axis| {
        let [a, b, c] = triangle.map(|p| without(axis, p));
        turn(a, b, c)
    });
    let widest = (0..3).max_by(|&i, &j| turns[i].abs().total_cmp(&turns[j].abs()))?;
    (turns[widest] != 0.0).then_some((widest, turns[widest]))
}
