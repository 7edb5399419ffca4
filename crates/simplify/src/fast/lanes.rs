//! Four vectors that go through the same arithmetic, a coordinate of all in one register.
//!
//! What a contraction does to attributes goes by these: glam's four floats are a register on every machine
//! that has them, and the numbers are the same on all. All else goes eight at a time, see `wide.rs`.

use std::ops::{Add, Sub};

use glam::{Mat4, Vec3, Vec4};

use crate::fast::hood::ROOM;

/// How many.
pub(super) const LANES: usize = 4;

/// A vector of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes3 {
    pub(super) x: Vec4,
    pub(super) y: Vec4,
    pub(super) z: Vec4,
}

impl Add for Lanes3 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Sub for Lanes3 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl Lanes3 {
    /// Four of the vectors in three rows, from `start` on.
    #[inline(always)]
    pub(super) fn load([x, y, z]: &[[f32; ROOM]; 3], start: usize) -> Self {
        let at = |of: &[f32; ROOM]| Vec4::from_slice(&of[start..]);
        Self { x: at(x), y: at(y), z: at(z) }
    }

    #[inline(always)]
    pub(super) fn all(v: Vec3) -> Self {
        Self { x: Vec4::splat(v.x), y: Vec4::splat(v.y), z: Vec4::splat(v.z) }
    }

    #[inline(always)]
    pub(super) fn dot(self, other: Self) -> Vec4 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(super) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    #[inline(always)]
    pub(super) fn by(self, factor: Vec4) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

/// Four rows of four as four columns.
#[inline(always)]
pub(super) fn transpose(a: Vec4, b: Vec4, c: Vec4, d: Vec4) -> [Vec4; 4] {
    let Mat4 { x_axis, y_axis, z_axis, w_axis } = Mat4::from_cols(a, b, c, d).transpose();
    [x_axis, y_axis, z_axis, w_axis]
}
