//! What the edges of a vertex cost: the least sum of squared volumes that a new vertex sweeps, among
//! the places that keep the volume. All from the stars of the two ends.
//!
//! Every plane of a star passes through its vertex. Seen from the middle of the edge, with ends at −h
//! and h, stars (A₀, N₀) and (A₁, N₁), S = A₀ + A₁, q = (A₁ − A₀)h and g = N₀ + N₁, the squares are
//! x'Sx − 2q·x + h'Sh, and the volume stays where g·x = (N₁ − N₀)·h. Faces that both stars have
//! contain h; they count twice in S and g and nowhere else.

use glam::Vec3;

use crate::fast::lanes::{LANES, Lanes, Lanes3};
use crate::fast::queue::{NONE, bucket};
use crate::fast::vertex::{Flags, NOBODY, Vertex};

/// How strongly the optimum is pulled to the middle of the edge, as in the general engine.
pub(super) const PULL: f32 = 1e-5;

/// What the square of half the length counts. Short edges go first where all costs are rounding,
/// which for these floats is a ten-millionth.
pub(super) const SHORT_FIRST: f32 = 1e-7;

/// Keeps a division by nothing from being one.
const TINY: f32 = 1e-30;

/// A vertex's cheapest edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cheapest {
    /// Of its cost; `NONE` if there is no edge.
    pub(super) bucket: u16,
    /// Its other end.
    pub(super) target: u32,
}

/// The cheapest edge from `u` around a ring, of those above `u`'s floor.
#[inline(always)]
pub(super) fn cheapest(all: &[Vertex], u: &Vertex, ring: &[u32]) -> Cheapest {
    let mut least = Cheapest { bucket: NONE, target: NOBODY };
    let mut least_cost = f32::INFINITY;
    for part in ring.chunks(LANES) {
        let mut ends = [[0.0; LANES]; 12];
        let mut special = u.flags.0;
        for (lane, &v) in part.iter().enumerate() {
            let v = &all[v as usize];
            special |= v.flags.0;
            ends[0][lane] = v.place.x;
            ends[1][lane] = v.place.y;
            ends[2][lane] = v.place.z;
            for k in 0..3 {
                ends[3 + k][lane] = v.star.normal[k];
            }
            for k in 0..6 {
                ends[6 + k][lane] = v.star.squares[k];
            }
        }
        let mut costs = costs(u, &ends).0;
        if Flags(special).any(SPECIAL) {
            correct(&mut costs, all, u, part);
        }
        for (lane, &v) in part.iter().enumerate() {
            let cost = costs[lane];
            let bucket = bucket(cost);
            if cost < least_cost && (u.floor == 0 || bucket > u.floor) {
                (least_cost, least) = (cost, Cheapest { bucket, target: v });
            }
        }
    }
    least
}

/// What makes a cost other than that of a free edge.
const SPECIAL: Flags = Flags(Flags::PINNED.0 | Flags::BARRED.0);

/// Costs of edges with an end that stays where it is, or that may not be contracted.
#[cold]
fn correct(costs: &mut [f32; LANES], all: &[Vertex], u: &Vertex, ring: &[u32]) {
    for (cost, &v) in costs.iter_mut().zip(ring) {
        let v = &all[v as usize];
        let pinned = [u, v].map(|end| end.flags.any(Flags::PINNED));
        *cost = match pinned {
            _ if v.flags.any(Flags::BARRED) || u.flags.any(Flags::BARRED) => f32::INFINITY,
            [false, false] => *cost,
            [true, true] => f32::INFINITY,
            [true, false] => swept(v, u.place),
            [false, true] => swept(u, v.place),
        };
    }
}

/// What a vertex's own star costs if it goes to a place.
fn swept(vertex: &Vertex, to: Vec3) -> f32 {
    let Vec3 { x, y, z } = to - vertex.place;
    let [xx, yy, zz, xy, xz, yz] = vertex.star.squares;
    let squares = xx * x * x + yy * y * y + zz * z * z;
    squares
        + 2.0 * (xy * x * y + xz * x * z + yz * y * z)
        + SHORT_FIRST * (xx + yy + zz) * (x * x + y * y + z * z)
}

/// A symmetric matrix of each: xx, yy, zz, xy, xz, yz.
#[derive(Clone, Copy)]
struct Symmetric([Lanes; 6]);

impl Symmetric {
    /// The product with a vector.
    #[inline(always)]
    fn apply(&self, Lanes3 { x, y, z }: Lanes3) -> Lanes3 {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        Lanes3 {
            x: xx * x + xy * y + xz * z,
            y: xy * x + yy * y + yz * z,
            z: xz * x + yz * y + zz * z,
        }
    }
}

/// The costs of edges from `u`. Symmetric: the same from either end, to the bit.
#[inline(always)]
fn costs(u: &Vertex, ends: &[[f32; LANES]; 12]) -> Lanes {
    let own = Lanes::all;
    let vector =
        |k: usize| Lanes3 { x: Lanes(ends[k]), y: Lanes(ends[k + 1]), z: Lanes(ends[k + 2]) };
    let h = (vector(0) - Lanes3::all(u.place)).by(own(0.5));
    let (n0, n1) = (Lanes3::all(u.star.normal.into()), vector(3));
    let mut sum = Symmetric([own(0.0); 6]);
    let mut difference = sum;
    for k in 0..6 {
        let (a0, a1) = (own(u.star.squares[k]), Lanes(ends[6 + k]));
        sum.0[k] = a1 + a0;
        difference.0[k] = a1 - a0;
    }
    let trace = sum.0[0] + sum.0[1] + sum.0[2];
    let scale = own(1.0) / (trace + own(TINY));

    let q = difference.apply(h);
    let at_middle = sum.apply(h).dot(h);
    let g = n0 + n1;
    let to_unit = own(1.0) / (g.dot(g) + own(TINY));
    // The place on the plane of equal volumes that is next to the middle.
    let x0 = g.by((n1 - n0).dot(h) * to_unit);
    let slope = q - sum.apply(x0);
    let there = at_middle - x0.dot(q + slope);

    // Two directions in the plane, at right angles, the second along the slope.
    let to_unit = to_unit.sqrt();
    let e1 = g.cross(slope).by(scale * to_unit);
    let e2 = g.cross(e1).by(to_unit);
    let (a1, a2) = (sum.apply(e1), sum.apply(e2));
    let along = e1.dot(e1);
    let pull = own(PULL) * along;
    let m11 = e1.dot(a1) * scale + pull;
    let m12 = e1.dot(a2) * scale;
    let m22 = e2.dot(a2) * scale + pull;
    let determinant = (m11 * m22 - m12 * m12).max(1e-36);
    let gain = along * along * m11 / determinant * trace;
    there - gain + own(SHORT_FIRST) * trace * h.dot(h)
}
