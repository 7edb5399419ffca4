//! Vertices in the grid of samples: fixed point, so that shared edges are the same to the bit.

use glam::DVec3;
use rayon::prelude::*;

use crate::camera::Lens;

/// Steps of a coordinate within one sample. Sample `i` lies at `i * SUBSTEPS + SUBSTEPS / 2`.
pub(crate) const SUBSTEPS: i32 = 256;

/// Coordinates beyond this many samples are clipped: 2^21 * 256 = 2^29 keeps the products of edge
/// functions below 2^62.
pub(crate) const GUARD: f64 = (1 << 21) as f64;

/// A vertex on the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Point {
    /// In substeps from the left.
    pub x: i32,
    /// In substeps from the top.
    pub y: i32,
    /// Near plane by depth: 1 at the near plane, falling to 0. It is linear over the picture.
    pub nearness: f32,
}

/// A projected vertex, with what it lies beyond.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Projected {
    /// Of use only where `beyond` has no bit of [`beyond::CLIP`].
    pub point: Point,
    pub beyond: u8,
}

/// Bits of what a vertex lies beyond; a face with one bit at all corners is not seen.
pub(crate) mod beyond {
    pub(crate) const LEFT: u8 = 1;
    pub(crate) const RIGHT: u8 = 2;
    pub(crate) const TOP: u8 = 4;
    pub(crate) const BOTTOM: u8 = 8;
    /// Before the near plane, or of no finite place.
    pub(crate) const NEAR: u8 = 16;
    /// Too far out for fixed point.
    pub(crate) const GUARD: u8 = 32;
    /// Its faces are clipped.
    pub(crate) const CLIP: u8 = NEAR | GUARD;
}

/// Projects all vertices to a grid of `size` samples.
pub(crate) fn project(positions: &[[f64; 3]], lens: &Lens, size: [u32; 2]) -> Vec<Projected> {
    positions.par_iter().map(|&p| place(lens.project(DVec3::from(p)), lens.near(), size)).collect()
}

/// Divides by depth and rounds to substeps. `homogeneous` must be at or behind the near plane and
/// within the guard.
pub(crate) fn snap(homogeneous: DVec3, near: f64) -> Point {
    let scale = f64::from(SUBSTEPS) / homogeneous.z;
    let round = |x: f64| (x * scale + 0.5).floor() as i32;
    let nearness = (near / homogeneous.z) as f32;
    Point { x: round(homogeneous.x), y: round(homogeneous.y), nearness }
}

fn place(homogeneous: DVec3, near: f64, size: [u32; 2]) -> Projected {
    let depth = homogeneous.z;
    if !homogeneous.is_finite() || depth < near {
        return Projected { beyond: beyond::NEAR, ..Projected::default() };
    }
    let (x, y) = (homogeneous.x, homogeneous.y);
    let bits = [
        (x < 0.0, beyond::LEFT),
        (x > f64::from(size[0]) * depth, beyond::RIGHT),
        (y < 0.0, beyond::TOP),
        (y > f64::from(size[1]) * depth, beyond::BOTTOM),
        (x.abs().max(y.abs()) > GUARD * depth, beyond::GUARD),
    ];
    let beyond = bits.iter().map(|&(is, bit)| if is { bit } else { 0 }).sum();
    Projected { point: snap(homogeneous, near), beyond }
}
