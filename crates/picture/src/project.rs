//! Projection of vertices to fixed-point pixel coordinates, so that shared edges agree bit for bit.

use glam::DVec3;
use rayon::prelude::*;

use crate::camera::Lens;

/// Fixed-point steps per sample. Sample `i` lies at `i * SUBSTEPS + SUBSTEPS / 2`.
pub(crate) const SUBSTEPS: i32 = 256;

/// Guard band: coordinates beyond this many samples are clipped. 2^21 * 256 = 2^29 keeps the
/// products of edge functions below 2^62.
pub(crate) const GUARD: f64 = (1 << 21) as f64;

/// Projected vertex in fixed point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Point {
    /// Distance from the left, in substeps.
    pub x: i32,
    /// Distance from the top, in substeps.
    pub y: i32,
    /// Near plane divided by depth: 1 at the near plane, falling to 0; linear over the picture.
    pub nearness: f32,
}

/// Projected vertex with its outcode.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Projected {
    /// Valid only if `outcode` has no bit of [`outcode::CLIP`].
    pub point: Point,
    pub outcode: u8,
}

/// Outcode bits of a vertex; a face is invisible if all its corners share a bit.
pub(crate) mod outcode {
    pub(crate) const LEFT: u8 = 1;
    pub(crate) const RIGHT: u8 = 2;
    pub(crate) const TOP: u8 = 4;
    pub(crate) const BOTTOM: u8 = 8;
    /// In front of the near plane, or not finite.
    pub(crate) const NEAR: u8 = 16;
    /// Outside the guard band of fixed point.
    pub(crate) const GUARD: u8 = 32;
    /// Bits that require clipping of the face.
    pub(crate) const CLIP: u8 = NEAR | GUARD;
}

/// Projects all vertices to a grid of `size` samples.
pub(crate) fn project(positions: &[[f64; 3]], lens: &Lens, size: [u32; 2]) -> Vec<Projected> {
    positions.par_iter().map(|&p| place(lens.project(DVec3::from(p)), lens.near(), size)).collect()
}

/// Divides by depth and rounds to substeps. `homogeneous` must not be in front of the near plane or
/// outside the guard band.
pub(crate) fn snap(homogeneous: DVec3, near: f64) -> Point {
    let scale = f64::from(SUBSTEPS) / homogeneous.z;
    let round = |x: f64| (x * scale + 0.5).floor() as i32;
    let nearness = (near / homogeneous.z) as f32;
    Point { x: round(homogeneous.x), y: round(homogeneous.y), nearness }
}

fn place(homogeneous: DVec3, near: f64, size: [u32; 2]) -> Projected {
    let depth = homogeneous.z;
    if !homogeneous.is_finite() || depth < near {
        return Projected { outcode: outcode::NEAR, ..Projected::default() };
    }
    let (x, y) = (homogeneous.x, homogeneous.y);
    let bits = [
        (x < 0.0, outcode::LEFT),
        (x > f64::from(size[0]) * depth, outcode::RIGHT),
        (y < 0.0, outcode::TOP),
        (y > f64::from(size[1]) * depth, outcode::BOTTOM),
        (x.abs().max(y.abs()) > GUARD * depth, outcode::GUARD),
    ];
    let outcode = bits.iter().map(|&(is, bit)| if is { bit } else { 0 }).sum();
    Projected { point: snap(homogeneous, near), outcode }
}
