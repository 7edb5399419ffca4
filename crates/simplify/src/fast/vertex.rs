//! A vertex as the fast engine has it: 128 bytes, two lines of the cache.
//!
//! The first line is what a neighbour asks for when it looks for its cheapest edge, the second is the
//! ring. A look at a star reads both lines of its vertex and one of each neighbour, nothing else.

use glam::Vec3;

use crate::fast::ring::RING;

/// No vertex.
pub(super) const NOBODY: u32 = u32::MAX;

/// A live vertex, or one that has gone into another.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(128))]
pub(super) struct Vertex {
    /// Where it is, in the engine's frame.
    pub(super) place: Vec3,
    /// What the faces around it come to, seen from it.
    pub(super) star: Star,
    /// The neighbour that its cheapest edge goes to; of a dead one, the vertex it has gone into.
    pub(super) target: u32,
    /// The square of how far the surface has moved here.
    pub(super) moved: f32,
    /// The bucket that its entry in the queue is in.
    pub(super) bucket: u16,
    /// Edges up to this bucket have been refused since the ring changed.
    pub(super) floor: u16,
    pub(super) flags: Flags,
    /// How many of `ring` are its neighbours; `LONG` where they are elsewhere.
    pub(super) len: u8,
    /// The neighbours, counter-clockwise seen from outside.
    pub(super) ring: [u32; RING],
}

/// The sums of n n' and of n over the faces around a vertex, n twice the area along the normal.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(super) struct Star {
    pub(super) normal: [f32; 3],
    /// xx, yy, zz, xy, xz, yz.
    pub(super) squares: [f32; 6],
}

/// Yes-or-no facts about a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Flags(pub(super) u8);

impl Flags {
    /// It may not move.
    pub(super) const PINNED: Self = Self(1);
    /// It has gone into another.
    pub(super) const DEAD: Self = Self(2);
    /// No edge to it may be contracted: the ghost, and hubs until they have shrunk.
    pub(super) const BARRED: Self = Self(4);
    /// It is not where it was in the input.
    pub(super) const MOVED: Self = Self(8);
    /// A face of it has changed since it was looked at.
    pub(super) const STALE: Self = Self(32);
    /// One of the copies of a vertex where the surface is not manifold.
    pub(super) const SPLIT: Self = Self(16);

    #[inline(always)]
    pub(super) fn any(self, of: Self) -> bool {
        self.0 & of.0 != 0
    }

    #[inline(always)]
    pub(super) fn set(&mut self, flag: Self) {
        self.0 |= flag.0;
    }

    #[inline(always)]
    pub(super) fn clear(&mut self, flag: Self) {
        self.0 &= !flag.0;
    }
}

impl Star {
    #[inline(always)]
    pub(super) fn add(&mut self, change: &Self) {
        for k in 0..3 {
            self.normal[k] += change.normal[k];
        }
        for k in 0..6 {
            self.squares[k] += change.squares[k];
        }
    }

    /// The squares of the areas swept over a boundary edge, along `e`; seen from its ends.
    ///
    /// A half and a sixth of products of vectors make nine of them against volumes [LT99].
    #[inline(always)]
    pub(super) fn boundary(along: Vec3, weight: f32) -> Self {
        let Vec3 { x, y, z } = along;
        let squared = x * x + y * y + z * z;
        let w = weight * squared;
        let squares = [
            w * (squared - x * x),
            w * (squared - y * y),
            w * (squared - z * z),
            -w * x * y,
            -w * x * z,
            -w * y * z,
        ];
        Self { normal: [0.0; 3], squares }
    }

    #[inline(always)]
    pub(super) fn face(normal: Vec3) -> Self {
        let Vec3 { x, y, z } = normal;
        Self { normal: [x, y, z], squares: [x * x, y * y, z * z, x * y, x * z, y * z] }
    }

    #[inline(always)]
    pub(super) fn take(&mut self, change: &Self) {
        for k in 0..3 {
            self.normal[k] -= change.normal[k];
        }
        for k in 0..6 {
            self.squares[k] -= change.squares[k];
        }
    }

    #[inline(always)]
    pub(super) fn minus(mut self, other: &Self) -> Self {
        self.take(other);
        self
    }
}

impl Vertex {
    pub(super) fn at(place: Vec3) -> Self {
        Self {
            place,
            star: Star::default(),
            target: NOBODY,
            moved: 0.0,
            bucket: 0,
            floor: 0,
            flags: Flags::default(),
            len: 0,
            ring: [NOBODY; RING],
        }
    }
}

const _: () = assert!(size_of::<Vertex>() == 128);
