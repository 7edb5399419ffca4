//! What the edges of a vertex cost: the least that their squares come to, by the [rule](Rule), and a
//! little for their length.
//!
//! All from the squares at the two ends. Of planes through them, seen from the middle of the edge, with
//! ends at −h and h and matrices A₀ and A₁, those are x'Sx − 2q·x + h'Sh, S = A₀ + A₁, q = (A₁ − A₀)h; the
//! rule adds the rest.

use glam::{Vec3, Vec4};

use crate::fast::looks::Looks;
use crate::fast::queue::{NONE, bucket};
use crate::fast::ring::{LONG, MOST, Vertices};
use crate::fast::rule::{Rule, protection};
use crate::fast::vertex::{Flags, NOBODY};
use crate::fast::wide::{LANES, Row, Row3, most, transpose};

/// How strongly the optimum is pulled to the middle of the edge, as in the general engine.
pub(super) const PULL: f32 = 1e-5;

/// A vertex's cheapest edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cheapest {
    /// Of its cost; `NONE` if there is no edge.
    pub(super) bucket: u16,
    /// Its other end.
    pub(super) target: u32,
}

/// The cheapest edge from `u`, of those above its floor; its ring is up to date.
#[inline(always)]
pub(super) fn cheapest(vertices: &Vertices, looks: &impl Looks, u: u32) -> Cheapest {
    let vertex = vertices.get(u);
    match vertex.len {
        LONG => cheapest_of_many(vertices, looks, u),
        len => cheapest_of(vertices, looks, u, &vertex.ring, len.into()),
    }
}

#[cold]
fn cheapest_of_many(vertices: &Vertices, looks: &impl Looks, u: u32) -> Cheapest {
    let mut ring = [NOBODY; MOST];
    let all = vertices.settled(u);
    ring.iter_mut().zip(all).for_each(|(to, &w)| *to = w);
    cheapest_of(vertices, looks, u, &ring, all.len().min(MOST))
}

#[inline(always)]
fn cheapest_of<const ROOM: usize>(
    vertices: &Vertices,
    looks: &impl Looks,
    u: u32,
    ring: &[u32; ROOM],
    len: usize,
) -> Cheapest {
    let (mut least, mut left) = (Rank::LAST, len as u32);
    for some in ring.as_chunks::<LANES>().0 {
        // Lanes beyond the end look at the first one again.
        let mut ids = *some;
        for (lane, id) in (0..).zip(&mut ids) {
            *id = if lane < left { *id } else { some[0] };
        }
        let costs = costs(vertices, looks, Side::Of(u), &ids);
        for (cost, id) in costs.into_iter().zip(ids) {
            least = least.min(Rank::new(cost, id));
        }
        left = left.saturating_sub(LANES as u32);
        if left == 0 {
            break;
        }
    }
    least.cheapest()
}

/// An edge among others of its vertex, by its cost, then by its end. A number, since which one is less
/// is not to be guessed by a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Rank(u64);

impl Rank {
    /// Behind all edges.
    pub(super) const LAST: Self = Self(u64::MAX);

    /// What is no number costs more than anything.
    #[inline(always)]
    pub(super) fn new(cost: f32, to: u32) -> Self {
        let cost = if cost < f32::INFINITY { most(cost, 0.0) } else { f32::INFINITY };
        Self((u64::from(cost.to_bits()) << 32) | u64::from(to))
    }

    #[inline(always)]
    pub(super) fn cheapest(self) -> Cheapest {
        match bucket(f32::from_bits((self.0 >> 32) as u32)) {
            NONE => Cheapest { bucket: NONE, target: NOBODY },
            bucket => Cheapest { bucket, target: self.0 as u32 },
        }
    }
}

/// One end of eight edges: one and the same or one of each.
#[derive(Clone, Copy)]
pub(super) enum Side<T> {
    Of(T),
    Each([T; LANES]),
}

impl<T: Copy> Side<T> {
    #[inline(always)]
    pub(super) fn get(self, lane: usize) -> T {
        match self {
            Self::Of(end) => end,
            Self::Each(ends) => ends[lane],
        }
    }

    #[inline(always)]
    pub(super) fn map<U>(self, to: impl Fn(T) -> U) -> Side<U> {
        match self {
            Self::Of(end) => Side::Of(to(end)),
            Self::Each([a, b, c, d, e, f, g, h]) => {
                Side::Each([to(a), to(b), to(c), to(d), to(e), to(f), to(g), to(h)])
            }
        }
    }
}

impl Side<Vec4> {
    /// Four floats of each, in rows.
    #[inline(always)]
    pub(super) fn rows(self) -> [Row; 4] {
        match self {
            Self::Of(four) => {
                let [x, y, z, w] = four.to_array();
                [[x; LANES], [y; LANES], [z; LANES], [w; LANES]]
            }
            Self::Each(fours) => transpose(fours),
        }
    }
}

/// What eight edges cost; infinite where an edge may not be contracted, or costs no more than has been
/// refused at its first end.
#[inline(always)]
pub(super) fn costs<L: Looks>(
    vertices: &Vertices,
    looks: &L,
    us: Side<u32>,
    vs: &[u32; LANES],
) -> Row {
    let mut found = match looks.at_seams(vertices, us, vs) {
        Some(found) => found,
        None => {
            let (first, second) = (Stars::of(vertices, us), Stars::of(vertices, Side::Each(*vs)));
            let mut edges = Edges::between::<L::Rule>(&first, &second);
            looks.join([us, Side::Each(*vs)], &mut edges);
            let any_special = Flags(first.flags | second.flags).any(SPECIAL) || first.floor > 0;
            Costs { costs: edges.costs::<L::Rule>(), any_special }
        }
    };
    if found.any_special {
        correct(&mut found.costs, vertices, looks, us, vs);
    }
    found.costs
}

/// What eight edges cost if none is special.
pub(super) struct Costs {
    pub(super) costs: Row,
    /// Whether one may be: has an end with one of [`SPECIAL`], or a floor.
    pub(super) any_special: bool,
}

/// What makes a cost other than that of a free edge.
pub(super) const SPECIAL: Flags = Flags(Flags::PINNED.0 | Flags::SHUT.0 | Flags::PROTECTED.0);

/// Costs of edges with an end that stays where it is or goes late, or that may not be contracted, or
/// not now.
#[cold]
fn correct<L: Looks>(
    costs: &mut Row,
    vertices: &Vertices,
    looks: &L,
    us: Side<u32>,
    vs: &[u32; LANES],
) {
    for (lane, (cost, &v)) in costs.iter_mut().zip(vs).enumerate() {
        let u = us.get(lane);
        let floor = vertices.get(u).floor;
        let flags = Flags(vertices.get(u).flags.0 | vertices.get(v).flags.0);
        if !flags.any(SPECIAL) && floor == 0 {
            continue;
        }
        if flags.any(Flags::SHUT) {
            *cost = f32::INFINITY;
            continue;
        }
        if flags.any(Flags::PINNED) && !flags.any(Flags::SEAM) {
            *cost = match looks.order(vertices, u, v) {
                Err(_) => f32::INFINITY,
                Ok(ends) => {
                    let (end0, end1) = (vertices.get(ends.v0), vertices.get(ends.v1));
                    let weight = Symmetric(end1.seen.squares()).trace();
                    let length = end0.place().distance_squared(end1.place());
                    let short = L::Rule::SHORT_FIRST * weight * length;
                    L::Rule::onto(end0, end1) + short + looks.onto(vertices, &ends)
                }
            };
        }
        if flags.any(Flags::PROTECTED) {
            *cost *= protection::<L::Rule>();
        }
        if floor > 0 && bucket(*cost) <= floor {
            *cost = f32::INFINITY;
        }
    }
}

/// A symmetric matrix: xx, yy, zz, xy, xz, yz.
#[derive(Clone, Copy)]
pub(super) struct Symmetric(pub(super) [f32; 6]);

impl Symmetric {
    /// The product with a vector.
    #[inline(always)]
    pub(super) fn apply(&self, Vec3 { x, y, z }: Vec3) -> Vec3 {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        Vec3::new(xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z)
    }

    #[inline(always)]
    pub(super) fn trace(&self) -> f32 {
        self.0[0] + self.0[1] + self.0[2]
    }

    /// x'Ax.
    pub(super) fn at(&self, Vec3 { x, y, z }: Vec3) -> f32 {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        let squares = xx * x * x + yy * y * y + zz * z * z;
        squares + 2.0 * (xy * x * y + xz * x * z + yz * y * z)
    }
}

/// The product v v': xx, yy, zz, xy, xz, yz.
#[inline(always)]
pub(super) fn outer(Vec3 { x, y, z }: Vec3) -> [f32; 6] {
    [x * x, y * y, z * z, x * y, x * z, y * z]
}

/// The squares of eight vertices.
pub(super) struct Stars {
    pub(super) place: Row3,
    pub(super) vector: Row3,
    pub(super) squares: [Row; 6],
    pub(super) constant: Row,
    /// All that any of them has.
    flags: u8,
    /// Zero where none has any.
    floor: u16,
}

impl Stars {
    #[inline(always)]
    pub(super) fn of(vertices: &Vertices, side: Side<u32>) -> Self {
        let side = side.map(|v| vertices.get(v));
        let row = |k: usize| side.map(|vertex| vertex.seen.0[k]).rows();
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
pub(super) fn lane_of(rows: &[Row; 6], lane: usize) -> [f32; 6] {
    let [a, b, c, d, e, f] = rows;
    [a[lane], b[lane], c[lane], d[lane], e[lane], f[lane]]
}

/// Squares of one edge, seen from its middle: S, q and c.
pub(super) struct Part {
    pub(super) sum: Symmetric,
    pub(super) slope: Vec3,
    pub(super) at_middle: f32,
}

impl Part {
    pub(super) const NONE: Self =
        Self { sum: Symmetric([0.0; 6]), slope: Vec3::ZERO, at_middle: 0.0 };
}

/// The squares of eight edges, seen from the middle of each: x'Sx − 2 q·x + c. The volume stays where g·x
/// is `level`, if the rule asks for that. The same from either end, to the bit, but at seams.
pub(super) struct Edges {
    pub(super) half: Row3,
    /// S.
    pub(super) sum: [Row; 6],
    /// q.
    pub(super) slope: Row3,
    /// c.
    pub(super) at_middle: Row,
    /// g.
    pub(super) normal: Row3,
    pub(super) level: Row,
}

impl Edges {
    pub(super) const ZERO: Self = Self {
        half: Row3::ZERO,
        sum: [[0.0; LANES]; 6],
        slope: Row3::ZERO,
        at_middle: [0.0; LANES],
        normal: Row3::ZERO,
        level: [0.0; LANES],
    };

    #[inline(always)]
    pub(super) fn between<R: Rule>(first: &Stars, second: &Stars) -> Self {
        let mut edges = Self::ZERO;
        for lane in 0..LANES {
            let h = (second.place.get(lane) - first.place.get(lane)) * 0.5;
            let a0 = Symmetric(lane_of(&first.squares, lane));
            let a1 = Symmetric(lane_of(&second.squares, lane));
            let (a0h, a1h) = (a0.apply(h), a1.apply(h));
            for (sum, (a0, a1)) in edges.sum.iter_mut().zip(a0.0.into_iter().zip(a1.0)) {
                sum[lane] = a0 + a1;
            }
            edges.half.set(lane, h);
            edges.slope.set(lane, a1h - a0h);
            edges.at_middle[lane] = (a1h + a0h).dot(h);
            R::complete(&mut edges, lane, first, second);
        }
        edges
    }

    /// The squares of one.
    #[inline(always)]
    pub(super) fn part(&self, lane: usize) -> Part {
        let (slope, at_middle) = (self.slope.get(lane), self.at_middle[lane]);
        Part { sum: Symmetric(lane_of(&self.sum, lane)), slope, at_middle }
    }

    /// Gives one these squares.
    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, part: &Part) {
        for (sum, part) in self.sum.iter_mut().zip(part.sum.0) {
            sum[lane] = part;
        }
        self.slope.set(lane, part.slope);
        self.at_middle[lane] = part.at_middle;
    }

    /// Adds to the squares of one.
    #[inline(always)]
    pub(super) fn add(&mut self, lane: usize, part: &Part) {
        for (sum, part) in self.sum.iter_mut().zip(part.sum.0) {
            sum[lane] += part;
        }
        self.slope.set(lane, self.slope.get(lane) + part.slope);
        self.at_middle[lane] += part.at_middle;
    }

    /// What each costs.
    #[inline(always)]
    pub(super) fn costs<R: Rule>(&self) -> Row {
        let mut costs = [0.0; LANES];
        for (lane, cost) in costs.iter_mut().enumerate() {
            let h = self.half.get(lane);
            let trace = Symmetric(lane_of(&self.sum, lane)).trace();
            *cost = R::least(self, lane) + R::SHORT_FIRST * trace * h.dot(h);
        }
        costs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_comes_last() {
        let rank = |cost| Rank::new(cost, 7);
        assert!(
            rank(-1.0) == rank(0.0) && rank(0.0) < rank(1e-30) && rank(2.0) < Rank::new(2.0, 8)
        );
        for cost in [f32::NAN, f32::INFINITY] {
            assert_eq!(rank(cost).cheapest(), Cheapest { bucket: NONE, target: NOBODY });
            assert!(rank(f32::MAX) < rank(cost));
        }
    }
}
