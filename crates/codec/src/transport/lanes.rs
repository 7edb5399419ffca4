//! Arithmetic on the points of four blocks at a time, one in each lane.
//!
//! All operations are `f32` sums, products and quotients, each rounded by itself, so that a lane does
//! not depend on the others. No number is NaN, so least and greatest ones are the same everywhere.

use glam::{BVec4A, Mat4, Vec4};

/// Number of blocks processed at a time.
pub(super) const LANES: usize = 4;

/// Point or vector of each lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vec3x4 {
    pub(super) x: Vec4,
    pub(super) y: Vec4,
    pub(super) z: Vec4,
}

impl Vec3x4 {
    /// Transposes points, dropping their fourth components.
    #[inline(always)]
    pub(super) fn new(places: [Vec4; LANES]) -> Self {
        let [a, b, c, d] = places;
        let Mat4 { x_axis, y_axis, z_axis, .. } = Mat4::from_cols(a, b, c, d).transpose();
        Self { x: x_axis, y: y_axis, z: z_axis }
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
    pub(super) fn each(self, by: impl Fn(Vec4) -> Vec4) -> Self {
        Self { x: by(self.x), y: by(self.y), z: by(self.z) }
    }

    /// Returns the coordinates in coding order: cyclic, with the axis of the normal's greatest
    /// component last.
    #[inline(always)]
    pub(super) fn turned(self, last: &LastAxis) -> [Vec4; 3] {
        let Self { x, y, z } = self;
        [last.select(y, z, x), last.select(z, x, y), last.select(x, y, z)]
    }

    /// Returns the point of coordinates in coding order.
    #[inline(always)]
    pub(super) fn turned_back([u, v, w]: [Vec4; 3], last: &LastAxis) -> Self {
        Self { x: last.select(w, v, u), y: last.select(u, w, v), z: last.select(v, u, w) }
    }

    /// Returns the point of each lane, with 0 as fourth component.
    #[inline(always)]
    pub(super) fn points(self) -> [Vec4; LANES] {
        let Mat4 { x_axis, y_axis, z_axis, w_axis } =
            Mat4::from_cols(self.x, self.y, self.z, Vec4::ZERO).transpose();
        [x_axis, y_axis, z_axis, w_axis]
    }
}

impl std::ops::Add for Vec3x4 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl std::ops::Sub for Vec3x4 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

/// Axis that is coded last.
#[derive(Clone, Copy, Debug)]
pub(super) struct LastAxis {
    is_x: BVec4A,
    is_y: BVec4A,
}

impl LastAxis {
    #[inline(always)]
    pub(super) fn of(normal: Vec3x4) -> Self {
        let Vec3x4 { x, y, z } = normal.each(Vec4::abs);
        let is_y = y.cmpgt(x.max(z));
        Self { is_x: x.cmpgt(z) & !is_y, is_y }
    }

    /// Codes z last in a lane.
    pub(super) fn set_z(&mut self, lane: usize) {
        self.is_x.set(lane, false);
        self.is_y.set(lane, false);
    }

    #[inline(always)]
    pub(super) fn select(&self, x: Vec4, y: Vec4, z: Vec4) -> Vec4 {
        Vec4::select(self.is_x, x, Vec4::select(self.is_y, y, z))
    }
}
