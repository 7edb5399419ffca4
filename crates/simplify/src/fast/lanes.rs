//! A few numbers that go through the same arithmetic. Plain loops over arrays: the compiler makes them
//! as wide as the machine is, and the numbers are the same on every one.

use std::ops::{Add, Div, Mul, Sub};

use glam::Vec3;

/// How many.
pub(super) const LANES: usize = 4;

/// One number of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes(pub(super) [f32; LANES]);

/// A vector of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes3 {
    pub(super) x: Lanes,
    pub(super) y: Lanes,
    pub(super) z: Lanes,
}

// Closures over arrays, as `from_fn` and `map` take them, are not always inlined; that made it all
// four times as slow.
macro_rules! each {
    ($trait:ident, $name:ident, $op:tt) => {
        impl $trait for Lanes {
            type Output = Self;
            #[inline(always)]
            #[allow(clippy::needless_range_loop)]
            fn $name(self, other: Self) -> Self {
                let mut all = [0.0; LANES];
                for i in 0..LANES {
                    all[i] = self.0[i] $op other.0[i];
                }
                Self(all)
            }
        }

        impl $trait for Lanes3 {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self { x: self.x $op other.x, y: self.y $op other.y, z: self.z $op other.z }
            }
        }
    };
}

each!(Add, add, +);
each!(Sub, sub, -);
each!(Mul, mul, *);
each!(Div, div, /);

impl Lanes {
    #[inline(always)]
    pub(super) fn all(value: f32) -> Self {
        Self([value; LANES])
    }

    #[inline(always)]
    pub(super) fn max(mut self, least: f32) -> Self {
        for x in &mut self.0 {
            *x = if *x > least { *x } else { least };
        }
        self
    }

    #[inline(always)]
    pub(super) fn sqrt(mut self) -> Self {
        for x in &mut self.0 {
            *x = x.sqrt();
        }
        self
    }

    /// Those of a list from `start` on.
    #[inline(always)]
    pub(super) fn of(list: &[f32], start: usize) -> Self {
        Self(*list[start..].first_chunk().expect("lists have room for lanes beyond their end"))
    }
}

impl Lanes3 {
    #[inline(always)]
    pub(super) fn all(v: Vec3) -> Self {
        let Vec3 { x, y, z } = v;
        Self { x: Lanes::all(x), y: Lanes::all(y), z: Lanes::all(z) }
    }

    #[inline(always)]
    pub(super) fn dot(self, other: Self) -> Lanes {
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
    pub(super) fn by(self, factor: Lanes) -> Self {
        Self { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}
