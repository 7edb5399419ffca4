//! A vertex of the kernel: 128 bytes, two cache lines.
//!
//! The first line holds what a neighbour reads to find its cheapest edge, the second the ring.
//! Costing all edges of a vertex reads both of its lines and one line of each neighbour.

use glam::{Vec3, Vec4};

use crate::kernel::simd::TINY;

/// Number of neighbours that a vertex has room for. Of horse-97k's vertices on the way to 1 %,
/// fewer than one in a thousand have more.
pub(crate) const RING: usize = 16;

/// Id that stands for no vertex.
pub(crate) const NO_VERTEX: u32 = u32::MAX;

/// A live vertex, or one that has been contracted into another.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(128))]
pub(crate) struct Vertex {
    /// Position of the vertex in the frame, and its quadric there.
    pub(crate) quadric: VertexQuadric,
    /// Other end of the vertex's cheapest edge. For a dead vertex, the vertex that it was
    /// contracted into.
    pub(crate) target: u32,
    /// Square of the distance that the surface has moved at the vertex.
    pub(crate) moved: f32,
    /// Bucket of the vertex's entry in the queue.
    pub(crate) bucket: u16,
    /// Highest bucket whose edges at this vertex have been refused since its ring changed.
    pub(crate) floor: u16,
    pub(crate) flags: VertexFlags,
    /// Number of neighbours in `ring`, or [`LONG`](crate::kernel::mesh::one_ring::LONG) if they are
    /// in a list.
    pub(crate) len: u8,
    /// Constant term of the vertex's quadric.
    pub(crate) constant: Bf16,
    /// Neighbours of the vertex, counter-clockwise as seen from outside.
    pub(crate) ring: [u32; RING],
}

/// Place of a vertex and its quadric relative to that place, in three registers: the place, a
/// vector, and a symmetric matrix as xx, yy, zz, xy, xz, yz.
///
/// For `lindstrom-turk` these are the sums of n and of n n' over the faces around, where n is twice
/// the area along the normal; for `qem`, b and A of x'Ax − 2b·x + c.
///
/// ```text
/// place.x place.y place.z  x | y z  xx yy | zz xy xz yz
/// ```
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct VertexQuadric(pub(crate) [Vec4; 3]);

/// Constant term c of x'Ax − 2b·x + c, the value of a quadric at its vertex: a float without its
/// lower half, for lack of room. It is off by one part in 256, while buckets are a fifth apart.
/// Where nothing is forgotten, increments smaller than its precision are lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Bf16(u16);

/// Quadric of a vertex with its constant term.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FullQuadric {
    pub(crate) star: VertexQuadric,
    pub(crate) constant: Bf16,
}

/// Set of flags of a vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct VertexFlags(pub(crate) u8);

impl VertexFlags {
    /// The vertex must not move.
    pub(crate) const PINNED: Self = Self(1);
    /// The vertex has been contracted into another.
    pub(crate) const DEAD: Self = Self(2);
    /// Edges to this vertex must not be contracted: the ghost, and hubs until they have shrunk.
    pub(crate) const BARRED: Self = Self(4);
    /// A face of the vertex has changed since it was costed.
    pub(crate) const STALE: Self = Self(8);
    /// The vertex has neighbours in another part, and waits until both parts are one.
    pub(crate) const OUTER: Self = Self(64);
    /// Edges to this vertex must not be contracted at present.
    pub(crate) const SHUT: Self = Self(Self::BARRED.0 | Self::OUTER.0);
    /// The vertex has no valid queue entry: dead, barred, or waiting for another part.
    pub(crate) const INACTIVE: Self = Self(Self::DEAD.0 | Self::SHUT.0);
    /// The vertex moves together with those it is tied to, or not at all.
    pub(crate) const TIED: Self = Self(16);
    /// The vertex is protected: contractions that move it cost
    /// [more](crate::kernel::mesh::one_ring::VertexStore::protection).
    pub(crate) const PROTECTED: Self = Self(128);
    /// The vertex has several wedges, or one in a slot other than its own id.
    pub(crate) const SEAM: Self = Self(32);

    /// The vertex is not free to move by itself.
    pub(crate) const HELD: Self = Self(Self::PINNED.0 | Self::TIED.0);

    /// The cost of an edge at this vertex differs from that of a free edge.
    pub(crate) const SPECIAL: Self =
        Self(Self::PINNED.0 | Self::SHUT.0 | Self::PROTECTED.0 | Self::TIED.0);

    #[inline(always)]
    pub(crate) fn any(self, of: Self) -> bool {
        self.0 & of.0 != 0
    }

    /// Returns true if a vertex with these flags stays where it is when its edge to one with
    /// `other` is contracted.
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

    /// Rounds to the nearest value. Values below zero are rounding errors and become zero.
    #[inline(always)]
    pub(crate) fn new(value: f32) -> Self {
        Self((value.max(0.0).to_bits().saturating_add(1 << 15) >> 16) as u16)
    }

    #[inline(always)]
    pub(crate) fn get(self) -> f32 {
        f32::from_bits(u32::from(self.0) << 16)
    }
}

/// Returns the weight of a face's squared swept volumes in the costs of `lindstrom-turk`, from the
/// square of twice its area: one over the root of twice its area.
///
/// Squared volumes [LT98] weigh an area by its square, so what is small goes early, however far it
/// sticks out. Plane distances weigh it once, and lose in the mean. Geometric means over four
/// levels of nineteen models, relative to this weight: squared volumes as they are .99 in the mean,
/// 1.07 in the maximum (with a limit of 5 and the former floor in `deferral.rs`); one over the power
/// .3 of twice the area 1.01, 1.08; .4 1.00, 1.02; .65 1.02, 1.05.
#[inline(always)]
pub(crate) fn per_square(squared: f32) -> f32 {
    (squared + TINY).sqrt().sqrt().recip()
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

    /// Returns the quadric of one face, without a position.
    #[inline(always)]
    pub(crate) fn face(normal: Vec3) -> Self {
        let Vec3 { x, y, z } = normal;
        let second = Vec4::new(y, z, x, y) * Vec4::new(1.0, 1.0, x, y);
        let third = Vec4::new(z, x, x, y) * Vec4::new(z, y, z, z);
        let w = per_square(normal.dot(normal));
        let second = second * Vec4::new(1.0, 1.0, w, w);
        Self([Vec4::new(0.0, 0.0, 0.0, x), second, third * w])
    }

    /// Returns the quadric of the areas swept over by a boundary edge, relative to either end.
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

    /// Returns the matrix of the quadric: xx, yy, zz, xy, xz, yz.
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

    /// Moves the vertex to a position, and gives it the quadric there.
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
    fn bf16_is_off_by_less_than_one_part_in_two_hundred() {
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
