//! Axis-aligned bounding boxes in `f32`.

use glam::Vec3;

use crate::triangle::Triangle;

/// Axis-aligned box given by its least and greatest corners; empty if the least is above.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Box3 {
    pub(crate) lo: Vec3,
    pub(crate) hi: Vec3,
}

impl Box3 {
    pub(crate) const EMPTY: Self = Self { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };

    /// Returns the least `f32` box that contains a triangle.
    #[inline]
    pub(crate) fn around(&[a, b, c]: &Triangle) -> Self {
        let (lo, hi) = (a.min(b).min(c), a.max(b).max(c));
        Self {
            lo: Vec3::from_array(lo.to_array().map(round_down)),
            hi: Vec3::from_array(hi.to_array().map(round_up)),
        }
    }

    #[inline]
    pub(crate) fn merged(&self, other: &Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// Returns true if two boxes have a point in common.
    #[inline]
    pub(crate) fn meets(&self, other: &Self) -> bool {
        self.lo.cmple(other.hi).all() && other.lo.cmple(self.hi).all()
    }

    /// Returns twice the centre, which compares as the centre does.
    #[inline]
    pub(crate) fn center(&self) -> Vec3 {
        self.lo + self.hi
    }

    /// Returns half the surface area; 0 for the empty box.
    #[inline]
    pub(crate) fn area(&self) -> f32 {
        let size = (self.hi - self.lo).max(Vec3::ZERO);
        size.x * (size.y + size.z) + size.y * size.z
    }
}

/// Returns the greatest `f32` that is not above `x`.
pub(crate) fn round_down(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) > x { nearest.next_down() } else { nearest }
}

/// Returns the least `f32` that is not below `x`.
pub(crate) fn round_up(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) < x { nearest.next_up() } else { nearest }
}
