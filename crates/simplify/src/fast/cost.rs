//! What the edges of a vertex cost: the least sum of squared volumes that a new vertex sweeps, among
//! the places that keep the volume. All from the stars of the two ends.
//!
//! Every plane of a star passes through its vertex. Seen from the middle of the edge, with ends at −h
//! and h, stars (A₀, N₀) and (A₁, N₁), S = A₀ + A₁, q = (A₁ − A₀)h and g = N₀ + N₁, the squares are
//! x'Sx − 2q·x + h'Sh, and the volume stays where g·x = (N₁ − N₀)·h. Faces that both stars have
//! contain h; they count twice in S and g and nowhere else.

use crate::fast::lanes::{LANES, Lanes, Lanes3};
use crate::fast::queue::{NONE, bucket};
use crate::fast::vertex::{Flags, NOBODY, Vertex};

/// How strongly the optimum is pulled to the middle of the edge, as in the general engine.
pub(super) const PULL: f32 = 1e-5;

/// What the square of half the length counts. Short edges go first where all costs are rounding,
/// which for these floats is a ten-millionth.
const SHORT_FIRST: f32 = 1e-7;

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
            for k in 0..3 {
                ends[k][lane] = v.place[k];
                ends[3 + k][lane] = v.star.normal[k];
            }
            for k in 0..6 {
                ends[6 + k][lane] = v.star.squares[k];
            }
        }
        let mut costs = costs(u, &ends.map(Lanes)).0;
        if Flags(special).any(SPECIAL) {
            correct(&mut costs, all, u, part);
        }
        for (&v, &cost) in part.iter().zip(&costs) {
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
pub(super) fn swept(vertex: &Vertex, to: [f32; 3]) -> f32 {
    let [x, y, z] = [0, 1, 2].map(|k| to[k] - vertex.place[k]);
    let [xx, yy, zz, xy, xz, yz] = vertex.star.squares;
    let squares = xx * x * x + yy * y * y + zz * z * z;
    squares
        + 2.0 * (xy * x * y + xz * x * z + yz * y * z)
        + SHORT_FIRST * (xx + yy + zz) * (x * x + y * y + z * z)
}

/// The product of a symmetric matrix and a vector.
#[inline(always)]
fn apply([xx, yy, zz, xy, xz, yz]: &[Lanes; 6], Lanes3([x, y, z]): Lanes3) -> Lanes3 {
    Lanes3([*xx * x + *xy * y + *xz * z, *xy * x + *yy * y + *yz * z, *xz * x + *yz * y + *zz * z])
}

/// The costs of eight edges from `u`. Symmetric: the same from either end, to the bit.
#[inline(always)]
fn costs(u: &Vertex, ends: &[Lanes; 12]) -> Lanes {
    let own = |x: f32| Lanes::all(x);
    let [px, py, pz] = u.place.map(own);
    let h = Lanes3([ends[0] - px, ends[1] - py, ends[2] - pz]).by(own(0.5));
    let n0 = Lanes3(u.star.normal.map(own));
    let n1 = Lanes3([ends[3], ends[4], ends[5]]);
    let a0 = u.star.squares.map(own);
    let sum: [Lanes; 6] = std::array::from_fn(|k| ends[6 + k] + a0[k]);
    let difference: [Lanes; 6] = std::array::from_fn(|k| ends[6 + k] - a0[k]);
    let trace = sum[0] + sum[1] + sum[2];
    let scale = own(1.0) / (trace + own(TINY));

    let q = apply(&difference, h);
    let at_middle = apply(&sum, h).dot(h);
    let g = n0 + n1;
    let gg = g.dot(g) + own(TINY);
    // The place on the plane of equal volumes that is next to the middle.
    let x0 = g.by((n1 - n0).dot(h) / gg);
    let slope = q - apply(&sum, x0);
    let there = at_middle - x0.dot(q + slope);

    // Two directions in the plane, at right angles, the second along the slope.
    let e1 = g.cross(slope).by(scale / gg.sqrt());
    let e2 = g.cross(e1).by(own(1.0) / gg.sqrt());
    let (a1, a2) = (apply(&sum, e1), apply(&sum, e2));
    let along = e1.dot(e1);
    let pull = own(PULL) * along;
    let m11 = e1.dot(a1) * scale + pull;
    let m12 = e1.dot(a2) * scale;
    let m22 = e2.dot(a2) * scale + pull;
    let determinant = (m11 * m22 - m12 * m12).max(1e-36);
    let gain = along * along * m11 / determinant * trace;
    there - gain + own(SHORT_FIRST) * trace * h.dot(h)
}
