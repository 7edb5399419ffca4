//! Eight numbers that go through the same arithmetic. Plain loops over arrays: the compiler makes
//! them as wide as the machine is, and the numbers are the same on every one.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Sub};

/// How many.
pub(super) const LANES: usize = 8;

/// One number of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes(pub(super) [f32; LANES]);

/// A vector of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes3(pub(super) [Lanes; 3]);

macro_rules! each {
    ($trait:ident, $name:ident, $op:tt) => {
        impl $trait for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(from_fn(|i| self.0[i] $op other.0[i]))
            }
        }

        impl $trait for Lanes3 {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(from_fn(|k| self.0[k] $op other.0[k]))
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
    pub(super) fn max(self, least: f32) -> Self {
        Self(from_fn(|i| if self.0[i] > least { self.0[i] } else { least }))
    }

    #[inline(always)]
    pub(super) fn sqrt(self) -> Self {
        Self(from_fn(|i| self.0[i].sqrt()))
    }
}

impl Lanes3 {
    #[inline(always)]
    pub(super) fn dot(self, other: Self) -> Lanes {
        let [x, y, z] = (self * other).0;
        x + y + z
    }

    #[inline(always)]
    pub(super) fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    #[inline(always)]
    pub(super) fn by(self, factor: Lanes) -> Self {
        Self(self.0.map(|x| x * factor))
    }
}
