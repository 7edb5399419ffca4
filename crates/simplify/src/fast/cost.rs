//! What the edges of a vertex cost: the least sum of squared volumes that a new vertex sweeps, among
//! the places that keep the volume. All from the stars of the two ends.
//!
//! Every plane of a star passes through its vertex. Seen from the middle of the edge, with ends at −h
//! and h, stars (A₀, N₀) and (A₁, N₁), S = A₀ + A₁, q = (A₁ − A₀)h and g = N₀ + N₁, the squares are
//! x'Sx − 2q·x + h'Sh, and the volume stays where g·x = (N₁ − N₀)·h. Faces that both stars have
//! contain h; they count twice in S and g and nowhere else.

use glam::{Vec3, Vec4};

use crate::fast::lanes::{LANES, Lanes3, transpose};
use crate::fast::looks::{Looks, Parts};
use crate::fast::place::{Swept, matrix};
use crate::fast::queue::bucket;
use crate::fast::ring::Vertices;
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
pub(super) fn cheapest(vertices: &Vertices, looks: &impl Looks, u: u32, ring: &[u32]) -> Cheapest {
    let own = vertices.get(u);
    let (mut least, mut target) = (f32::INFINITY, NOBODY);
    let mut start = 0;
    while start < ring.len() {
        // Lanes beyond the end look at the last one again.
        let id = |lane: usize| ring[(start + lane).min(ring.len() - 1)];
        let ids = [id(0), id(1), id(2), id(3)];
        let see = |lane: usize| vertices.get(ids[lane]);
        let ends = [see(0), see(1), see(2), see(3)];
        let special =
            own.flags.0 | ends[0].flags.0 | ends[1].flags.0 | ends[2].flags.0 | ends[3].flags.0;
        let mut costs = costs(looks, (u, own), &ids, &ends).to_array();
        if Flags(special).any(SPECIAL) || own.floor > 0 {
            correct(&mut costs, vertices, looks, u, &ids);
        }
        for (cost, id) in costs.into_iter().zip(ids) {
            if cost < least {
                (least, target) = (cost, id);
            }
        }
        start += LANES;
    }
    Cheapest { bucket: bucket(least), target }
}

/// What makes a cost other than that of a free edge.
const SPECIAL: Flags = Flags(Flags::PINNED.0 | Flags::SHUT.0 | Flags::SEAM.0);

/// Costs of edges with an end that stays where it is, or that may not be contracted, or not now.
#[cold]
fn correct(
    costs: &mut [f32; LANES],
    vertices: &Vertices,
    looks: &impl Looks,
    u: u32,
    ends: &[u32; LANES],
) {
    let floor = vertices.get(u).floor;
    for (cost, &v) in costs.iter_mut().zip(ends) {
        let flags = Flags(vertices.get(u).flags.0 | vertices.get(v).flags.0);
        if flags.any(Flags::SHUT) {
            *cost = f32::INFINITY;
            continue;
        }
        *cost = match looks.order(vertices, u, v) {
            Err(_) => f32::INFINITY,
            Ok(ends) if !ends.free => {
                let to = vertices.get(ends.v0).place();
                swept(vertices.get(ends.v1), to) + looks.onto(vertices, ends)
            }
            Ok(ends) if flags.any(Flags::SEAM) => {
                let (swept, short) = along(vertices.get(ends.v0), vertices.get(ends.v1));
                let whole = looks.whole(vertices, ends, swept);
                whole.at(whole.best()) as f32 + short
            }
            Ok(_) => *cost,
        };
        if floor > 0 && bucket(*cost) <= floor {
            *cost = f32::INFINITY;
        }
    }
}

/// The squares of one edge from the stars of its ends, and what its length counts.
fn along(v0: &Vertex, v1: &Vertex) -> (Swept, f32) {
    let half = (v1.place() - v0.place()).as_dvec3() * 0.5;
    let (a0, a1) = (matrix(&v0.seen), matrix(&v1.seen));
    let (n0, n1) = (v0.seen.normal().as_dvec3(), v1.seen.normal().as_dvec3());
    let swept = Swept {
        half,
        sum: a0 + a1,
        slope: (a1 - a0) * half,
        at_middle: half.dot((a0 + a1) * half),
        normal: n0 + n1,
        level: (n1 - n0).dot(half),
    };
    let short = SHORT_FIRST * (swept.weight() * half.length_squared()) as f32;
    (swept, short)
}

/// What a vertex's own star costs if it goes to a place.
fn swept(vertex: &Vertex, to: Vec3) -> f32 {
    let Vec3 { x, y, z } = to - vertex.place();
    let [xx, yy, zz, xy, xz, yz] = vertex.seen.squares();
    let squares = xx * x * x + yy * y * y + zz * z * z;
    squares
        + 2.0 * (xy * x * y + xz * x * z + yz * y * z)
        + SHORT_FIRST * (xx + yy + zz) * (x * x + y * y + z * z)
}

/// A symmetric matrix of each: xx, yy, zz, xy, xz, yz.
#[derive(Clone, Copy)]
struct Symmetric([Vec4; 6]);

impl Symmetric {
    /// The product with a vector.
    #[inline(always)]
    fn apply(&self, v: Lanes3) -> Lanes3 {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        let Lanes3 { x, y, z } = v;
        Lanes3 {
            x: xx * x + xy * y + xz * z,
            y: xy * x + yy * y + yz * z,
            z: xz * x + yz * y + zz * z,
        }
    }
}

/// The costs of edges from `u`. Symmetric: the same from either end, to the bit.
#[inline(always)]
fn costs(
    looks: &impl Looks,
    (id, u): (u32, &Vertex),
    ids: &[u32; LANES],
    ends: &[&Vertex; LANES],
) -> Vec4 {
    let row = |k: usize| {
        transpose(ends[0].seen.0[k], ends[1].seen.0[k], ends[2].seen.0[k], ends[3].seen.0[k])
    };
    let ([px, py, pz, nx], [ny, nz, xx, yy], [zz, xy, xz, yz]) = (row(0), row(1), row(2));
    let (mut own, mut theirs) = (u.seen.squares(), [xx, yy, zz, xy, xz, yz]);
    let weights = looks.squares(id, ids, &mut own, &mut theirs);
    let h = (Lanes3 { x: px, y: py, z: pz } - Lanes3::all(u.place())).by(Vec4::splat(0.5));
    let (n0, n1) = (Lanes3::all(u.seen.normal()), Lanes3 { x: nx, y: ny, z: nz });
    let [uxx, uyy, uzz, uxy, uxz, uyz] = own;
    let [xx, yy, zz, xy, xz, yz] = theirs;
    let own = Vec4::splat;
    let (uxx, uyy, uzz, uxy, uxz, uyz) =
        (own(uxx), own(uyy), own(uzz), own(uxy), own(uxz), own(uyz));
    let mut sum = Symmetric([xx + uxx, yy + uyy, zz + uzz, xy + uxy, xz + uxz, yz + uyz]);

    let (a0h, a1h) = (
        Symmetric([uxx, uyy, uzz, uxy, uxz, uyz]).apply(h),
        Symmetric([xx, yy, zz, xy, xz, yz]).apply(h),
    );
    let mut q = a1h - a0h;
    let mut at_middle = (a1h + a0h).dot(h);
    let parts = Parts { sum: &mut sum.0, slope: &mut q, at_middle: &mut at_middle };
    looks.join(id, ids, weights, h, parts);
    let trace = sum.0[0] + sum.0[1] + sum.0[2];
    let scale = (trace + own(TINY)).recip();
    let g = n0 + n1;
    let to_unit = (g.dot(g) + own(TINY)).recip();
    // The place on the plane of equal volumes that is next to the middle.
    let x0 = g.by((n1 - n0).dot(h) * to_unit);
    let slope = q - sum.apply(x0);
    let there = at_middle - x0.dot(q + slope);

    // Two directions in the plane, at right angles, the second along the slope; as long as keeps all
    // that follows about one.
    let across = g.cross(slope).by(scale);
    let e1 = across.by(to_unit);
    let e2 = g.cross(e1);
    let rise = e1.dot(across);
    let pull = own(PULL);
    let m11 = e1.dot(sum.apply(e1)) * scale + pull * e1.dot(e1);
    let (a2, long2) = (sum.apply(e2), e2.dot(e2));
    let m12 = e1.dot(a2) * scale;
    let m22 = e2.dot(a2) * scale + pull * long2;
    let determinant = (m11 * m22 - m12 * m12).max(own(1e-36));
    let gain = rise * rise * m11 / determinant * trace;
    there - gain + own(SHORT_FIRST) * trace * h.dot(h)
}
