//! A vertex as the fast engine has it: 128 bytes, two lines of the cache.
//!
//! The first line is what a neighbour asks for when it looks for its cheapest edge, the second is the
//! ring. A look at a star reads both lines of its vertex and one of each neighbour, nothing else.

use glam::{Vec3, Vec4};

/// How many neighbours a vertex has room for. Of horse-97k's vertices on the way to 1 %, fewer than
/// one in a thousand have more.
pub(crate) const RING: usize = 16;

/// No vertex.
pub(crate) const NO_VERTEX: u32 = u32::MAX;

/// A live vertex, or one that has gone into another.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(128))]
pub(crate) struct Vertex {
    /// Where it is, in the engine's frame, and what the faces around it come to: `place` and `star`.
    pub(crate) quadric: VertexQuadric,
    /// The neighbour that its cheapest edge goes to; of a dead one, the vertex it has gone into.
    pub(crate) target: u32,
    /// The square of how far the surface has moved here.
    pub(crate) moved: f32,
    /// The bucket that its entry in the queue is in.
    pub(crate) bucket: u16,
    /// EdgeQuadrics up to this bucket have been refused since the ring changed.
    pub(crate) floor: u16,
    pub(crate) flags: VertexFlags,
    /// How many of `ring` are its neighbours; `LONG` where they are elsewhere.
    pub(crate) len: u8,
    /// What its squares are at its own place.
    pub(crate) constant: Bf16,
    /// The neighbours, counter-clockwise seen from outside.
    pub(crate) ring: [u32; RING],
}

/// The squares at a vertex, seen from there, in three registers: (the place), a vector; a matrix as xx,
/// yy, zz, xy, xz, yz. By `lindstrom-turk` the sums of n and of n n' over the faces around, n twice the
/// area along the normal; by `qem` b and A of x'Ax − 2b·x + c.
///
/// ```text
/// place.x place.y place.z  x | y z  xx yy | zz xy xz yz
/// ```
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct VertexQuadric(pub(crate) [Vec4; 3]);

/// What squares are at their vertex itself, c of x'Ax − 2b·x + c: a float without its lower half, since
/// that is the room there is. It is off by one part in 256; costs are told apart by a fifth. Where all is
/// remembered, what comes to it in smaller parts is lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Bf16(u16);

/// All the squares of a vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FullQuadric {
    pub(crate) star: VertexQuadric,
    pub(crate) constant: Bf16,
}

/// Yes-or-no facts about a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct VertexFlags(pub(crate) u8);

impl VertexFlags {
    /// It may not move.
    pub(crate) const PINNED: Self = Self(1);
    /// It has gone into another.
    pub(crate) const DEAD: Self = Self(2);
    /// No edge to it may be contracted: the ghost, and hubs until they have shrunk.
    pub(crate) const BARRED: Self = Self(4);
    /// A face of it has changed since it was looked at.
    pub(crate) const STALE: Self = Self(8);
    /// It has neighbours in another part, so it waits until both are in one.
    pub(crate) const OUTER: Self = Self(64);
    /// No edge to it may be contracted, as things are.
    pub(crate) const SHUT: Self = Self(Self::BARRED.0 | Self::OUTER.0);
    /// It moves together with the others of its tie, or not at all.
    pub(crate) const TIED: Self = Self(16);
    /// It goes late: what moves it costs [more](crate::kernel::rule::protection).
    pub(crate) const PROTECTED: Self = Self(128);
    /// It has several wedges, or another slot than that of its own number.
    pub(crate) const SEAM: Self = Self(32);

    /// Not free by itself.
    pub(crate) const HELD: Self = Self(Self::PINNED.0 | Self::TIED.0);

    /// What makes a cost other than that of a free edge.
    pub(crate) const SPECIAL: Self =
        Self(Self::PINNED.0 | Self::SHUT.0 | Self::PROTECTED.0 | Self::TIED.0);

    #[inline(always)]
    pub(crate) fn any(self, of: Self) -> bool {
        self.0 & of.0 != 0
    }

    /// Whether a vertex stays where it is if an edge to one of these flags is contracted.
    #[inline(always)]
    pub(crate) fn stays_beside(self, other: Self) -> bool {
        self.any(Self::PINNED) || (self.any(Self::TIED) && !other.any(Self::TIED))
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, flag: Self) {
        self.0 |= flag.0;
    }

    #[inline(always)]
    pub(crate) fn clear(&mut self, flag: Self) {
        self.0 &= !flag.0;
    }
}

impl Bf16 {
    pub(crate) const NONE: Self = Self(0);

    /// The nearest to this; nothing below zero, which is rounding.
    #[inline(always)]
    pub(crate) fn new(value: f32) -> Self {
        Self((value.max(0.0).to_bits().saturating_add(1 << 15) >> 16) as u16)
    }

    #[inline(always)]
    pub(crate) fn get(self) -> f32 {
        f32::from_bits(u32::from(self.0) << 16)
    }
}

impl VertexQuadric {
    #[inline(always)]
    pub(crate) fn new(vector: Vec3, squares: [f32; 6]) -> Self {
        let ([xx, yy, zz, xy, xz, yz], Vec3 { x, y, z }) = (squares, vector);
        Self([Vec4::new(0.0, 0.0, 0.0, x), Vec4::new(y, z, xx, yy), Vec4::new(zz, xy, xz, yz)])
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, change: &Self) {
        self.0[0] += change.0[0];
        self.0[1] += change.0[1];
        self.0[2] += change.0[2];
    }

    #[inline(always)]
    pub(crate) fn take(&mut self, change: &Self) {
        self.0[0] -= change.0[0];
        self.0[1] -= change.0[1];
        self.0[2] -= change.0[2];
    }

    /// One face, without a place.
    #[inline(always)]
    pub(crate) fn face(normal: Vec3) -> Self {
        let Vec3 { x, y, z } = normal;
        let second = Vec4::new(y, z, x, y) * Vec4::new(1.0, 1.0, x, y);
        let third = Vec4::new(z, x, x, y) * Vec4::new(z, y, z, z);
        Self([Vec4::new(0.0, 0.0, 0.0, x), second, third])
    }

    /// The squares of the areas swept over a boundary edge; seen from its ends.
    pub(crate) fn boundary(along: Vec3, weight: f32) -> Self {
        let Vec3 { x, y, z } = along;
        let squared = along.length_squared();
        let w = weight * squared;
        Self([
            Vec4::ZERO,
            Vec4::new(0.0, 0.0, w * (squared - x * x), w * (squared - y * y)),
            Vec4::new(w * (squared - z * z), -w * x * y, -w * x * z, -w * y * z),
        ])
    }

    #[inline(always)]
    pub(crate) fn vector(&self) -> Vec3 {
        Vec3::new(self.0[0].w, self.0[1].x, self.0[1].y)
    }

    /// xx, yy, zz, xy, xz, yz.
    #[inline(always)]
    pub(crate) fn squares(&self) -> [f32; 6] {
        let [_, b, c] = &self.0;
        [b.z, b.w, c.x, c.y, c.z, c.w]
    }
}

impl Vertex {
    pub(crate) fn at(place: Vec3) -> Self {
        Self {
            quadric: VertexQuadric([place.extend(0.0), Vec4::ZERO, Vec4::ZERO]),
            target: NO_VERTEX,
            moved: 0.0,
            bucket: 0,
            floor: 0,
            flags: VertexFlags::default(),
            len: 0,
            constant: Bf16::NONE,
            ring: [NO_VERTEX; RING],
        }
    }

    #[inline(always)]
    pub(crate) fn place(&self) -> Vec3 {
        self.quadric.0[0].truncate()
    }

    /// Puts it at a place, with the squares that it has there.
    #[inline(always)]
    pub(crate) fn put(&mut self, place: Vec3, quadric: FullQuadric) {
        let VertexQuadric([first, second, third]) = quadric.star;
        self.quadric = VertexQuadric([place.extend(first.w), second, third]);
        self.constant = quadric.constant;
    }
}

const _: () = assert!(size_of::<Vertex>() == 128);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_is_off_by_less_than_one_part_in_two_hundred() {
        for i in 0..1000 {
            let value = 1e-20 * 1.1f32.powi(i % 500) * (1.0 + i as f32 / 1000.0);
            let off = Bf16::new(value).get() / value - 1.0;
            assert!(off.abs() < 1.0 / 200.0, "{value:e}: {off}");
        }
        for (value, expected) in
            [(0.0, 0.0), (-1e-3, 0.0), (1.0, 1.0), (f32::INFINITY, f32::INFINITY)]
        {
            assert_eq!(Bf16::new(value).get(), expected);
        }
    }
}
