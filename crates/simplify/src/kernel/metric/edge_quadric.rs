//! Quadrics of edges, eight at a time in single precision.

use glam::{Vec3, Vec4};

use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::simd::{LANES, Row, Row3, transpose};

/// Strength of the pull of the optimum to the middle of the edge, as in the policy engine.
pub(crate) const PULL: f32 = 1e-5;

/// One end of eight edges: shared by all, or one for each.
#[derive(Clone, Copy)]
pub(crate) enum EdgeSide<T> {
    Of(T),
    Each([T; LANES]),
}

impl<T: Copy> EdgeSide<T> {
    #[inline(always)]
    pub(crate) fn get(self, lane: usize) -> T {
        match self {
            Self::Of(end) => end,
            Self::Each(ends) => ends[lane],
        }
    }

    #[inline(always)]
    pub(crate) fn map<U>(self, to: impl Fn(T) -> U) -> EdgeSide<U> {
        match self {
            Self::Of(end) => EdgeSide::Of(to(end)),
            Self::Each([a, b, c, d, e, f, g, h]) => {
                EdgeSide::Each([to(a), to(b), to(c), to(d), to(e), to(f), to(g), to(h)])
            }
        }
    }
}

impl EdgeSide<Vec4> {
    /// Transposes four floats of each end into rows.
    #[inline(always)]
    pub(crate) fn rows(self) -> [Row; 4] {
        match self {
            Self::Of(four) => {
                let [x, y, z, w] = four.to_array();
                [[x; LANES], [y; LANES], [z; LANES], [w; LANES]]
            }
            Self::Each(fours) => transpose(fours),
        }
    }
}

/// Costs of eight edges.
pub(crate) struct Costs {
    pub(crate) costs: Row,
    /// True if an edge may have an end with a flag of
    /// [`SPECIAL`](crate::kernel::mesh::vertex::VertexFlags::SPECIAL), or a floor.
    pub(crate) any_special: bool,
}

/// Symmetric matrix: xx, yy, zz, xy, xz, yz.
#[derive(Clone, Copy)]
pub(crate) struct SymmetricMatrix(pub(crate) [f32; 6]);

impl SymmetricMatrix {
    /// Multiplies the matrix by a vector.
    #[inline(always)]
    pub(crate) fn apply(&self, Vec3 { x, y, z }: Vec3) -> Vec3 {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        Vec3::new(xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z)
    }

    #[inline(always)]
    pub(crate) fn trace(&self) -> f32 {
        self.0[0] + self.0[1] + self.0[2]
    }

    /// Evaluates x'Ax.
    pub(crate) fn at(&self, Vec3 { x, y, z }: Vec3) -> f32 {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        let squares = xx * x * x + yy * y * y + zz * z * z;
        squares + 2.0 * (xy * x * y + xz * x * z + yz * y * z)
    }
}

/// Returns the outer product v v': xx, yy, zz, xy, xz, yz.
#[inline(always)]
pub(crate) fn outer(Vec3 { x, y, z }: Vec3) -> [f32; 6] {
    [x * x, y * y, z * z, x * y, x * z, y * z]
}

/// Quadrics of eight vertices.
pub(crate) struct VertexQuadrics {
    pub(crate) place: Row3,
    pub(crate) vector: Row3,
    pub(crate) squares: [Row; 6],
    pub(crate) constant: Row,
    /// Union of the flags.
    pub(crate) flags: u8,
    /// Bitwise or of the floors; zero if no vertex has one.
    pub(crate) floor: u16,
}

impl VertexQuadrics {
    #[inline(always)]
    pub(crate) fn of(vertices: &Vertices, side: EdgeSide<u32>) -> Self {
        let side = side.map(|v| vertices.get(v));
        let row = |k: usize| side.map(|vertex| vertex.quadric.0[k]).rows();
        let ([x, y, z, vx], [vy, vz, xx, yy], [zz, xy, xz, yz]) = (row(0), row(1), row(2));
        let (mut flags, mut floor, mut constant) = (0, 0, [0.0; LANES]);
        for lane in 0..LANES {
            constant[lane] = side.get(lane).constant.get();
            flags |= side.get(lane).flags.0;
            floor |= side.get(lane).floor;
        }
        Self {
            place: Row3 { x, y, z },
            vector: Row3 { x: vx, y: vy, z: vz },
            squares: [xx, yy, zz, xy, xz, yz],
            constant,
            flags,
            floor,
        }
    }
}

#[inline(always)]
pub(crate) fn lane_of(rows: &[Row; 6], lane: usize) -> [f32; 6] {
    let [a, b, c, d, e, f] = rows;
    [a[lane], b[lane], c[lane], d[lane], e[lane], f[lane]]
}

/// Quadric of one edge relative to its middle: S, q and c.
pub(crate) struct EdgeQuadric {
    pub(crate) sum: SymmetricMatrix,
    pub(crate) slope: Vec3,
    pub(crate) at_middle: f32,
}

impl EdgeQuadric {
    pub(crate) const NONE: Self =
        Self { sum: SymmetricMatrix([0.0; 6]), slope: Vec3::ZERO, at_middle: 0.0 };
}

/// Quadrics of eight edges, each relative to its middle: x'Sx − 2 q·x + c. The volume is preserved
/// where g·x is `level`, if the metric asks for that. Away from seams both directions of an edge
/// give the same bits.
pub(crate) struct EdgeQuadrics {
    pub(crate) half: Row3,
    /// S.
    pub(crate) sum: [Row; 6],
    /// q.
    pub(crate) slope: Row3,
    /// c.
    pub(crate) at_middle: Row,
    /// g.
    pub(crate) normal: Row3,
    pub(crate) level: Row,
}

impl EdgeQuadrics {
    pub(crate) const ZERO: Self = Self {
        half: Row3::ZERO,
        sum: [[0.0; LANES]; 6],
        slope: Row3::ZERO,
        at_middle: [0.0; LANES],
        normal: Row3::ZERO,
        level: [0.0; LANES],
    };

    /// Returns the quadric of one edge.
    #[inline(always)]
    pub(crate) fn part(&self, lane: usize) -> EdgeQuadric {
        let (slope, at_middle) = (self.slope.get(lane), self.at_middle[lane]);
        EdgeQuadric { sum: SymmetricMatrix(lane_of(&self.sum, lane)), slope, at_middle }
    }

    /// Sets the quadric of one edge.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, part: &EdgeQuadric) {
        for (sum, part) in self.sum.iter_mut().zip(part.sum.0) {
            sum[lane] = part;
        }
        self.slope.set(lane, part.slope);
        self.at_middle[lane] = part.at_middle;
    }

    /// Adds to the quadric of one edge.
    #[inline(always)]
    pub(crate) fn add(&mut self, lane: usize, part: &EdgeQuadric) {
        for (sum, part) in self.sum.iter_mut().zip(part.sum.0) {
            sum[lane] += part;
        }
        self.slope.set(lane, self.slope.get(lane) + part.slope);
        self.at_middle[lane] += part.at_middle;
    }
}
