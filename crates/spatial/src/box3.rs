//! A box in `f32`.

use glam::Vec3;

use crate::triangle::Triangle;

/// Least and greatest corner; nothing where the least is above the greatest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Box3 {
    pub(crate) lo: Vec3,
    pub(crate) hi: Vec3,
}

impl Box3 {
    pub(crate) const EMPTY: Self = Self { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };

    /// The least `f32` box that holds a triangle.
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

    /// Twice the centre: enough to compare.
    #[inline]
    pub(crate) fn center(&self) -> Vec3 {
        self.lo + self.hi
    }

    /// Half the surface area; 0 for the empty box.
    #[inline]
    pub(crate) fn area(&self) -> f32 {
        let size = (self.hi - self.lo).max(Vec3::ZERO);
        size.x * (size.y + size.z) + size.y * size.z
    }
}

/// The greatest `f32` not above `x`.
pub(crate) fn round_down(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) > x { nearest.next_down() } else { nearest }
}

/// The least `f32` not below `x`.
pub(crate) fn round_up(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) < x { nearest.next_up() } else { nearest }
}
