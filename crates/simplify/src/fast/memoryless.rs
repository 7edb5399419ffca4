//! `lindstrom-turk` [LT98]: the squares of the volumes that the faces around sweep, at their least on
//! the plane where the volume stays. A vertex has those of the faces that it has now.
//!
//! Every plane of a star passes through its vertex. Seen from the middle of an edge, with ends at −h
//! and h, stars (A₀, N₀) and (A₁, N₁), S = A₀ + A₁, q = (A₁ − A₀)h and g = N₀ + N₁, the squares are
//! x'Sx − 2q·x + h'Sh, and the volume stays where g·x = (N₁ − N₀)·h. Faces that both stars have
//! contain h; they count twice in S and g and nowhere else.

use glam::{DVec3, Vec3};

use crate::fast::cost::{Edges, PULL, Stars, Symmetric, lane_of};
use crate::fast::hood::Hood;
use crate::fast::looks::{Ends, Placed};
use crate::fast::place::{Swept, matrix};
use crate::fast::ring::Vertices;
use crate::fast::rule::Rule;
use crate::fast::vertex::{Constant, Flags, Seen, Star, Vertex};
use crate::fast::wide::{TINY, most};

/// Forgets all that faces have been.
#[derive(Clone, Copy, Debug)]
pub(super) struct Memoryless;

#[cfg(test)]
impl Memoryless {
    /// The squares of one edge, in doubles, from those of its ends: faces that both have count twice.
    pub(super) fn along(end0: &Vertex, end1: &Vertex) -> Swept {
        let half = (end1.place() - end0.place()).as_dvec3() * 0.5;
        let (a0, a1) = (matrix(&end0.seen), matrix(&end1.seen));
        let (n0, n1) = (end0.seen.vector().as_dvec3(), end1.seen.vector().as_dvec3());
        Swept {
            half,
            sum: a0 + a1,
            slope: (a1 - a0) * half,
            at_middle: half.dot((a0 + a1) * half),
            normal: n0 + n1,
            level: (n1 - n0).dot(half),
        }
    }
}

impl Rule for Memoryless {
    const POWER: i32 = 6;

    /// [LT99]
    const BOUNDARY_WEIGHT: f32 = 9.0;

    /// Mean error of horse-97k at 10 %: 0 .00725, 1 .00723, 2 .00725, 4 .00724, 8 .00743.
    const SLACK: u16 = 4;

    const SHORT_FIRST: f32 = 1e-7;

    #[inline(always)]
    fn face(normal: Vec3) -> Star {
        Star::face(normal)
    }

    fn boundary(along: Vec3, _: Vec3, weight: f32) -> Star {
        Star::boundary(along, weight)
    }

    #[inline(always)]
    fn complete(edges: &mut Edges, lane: usize, first: &Stars, second: &Stars) {
        let (n0, n1) = (first.vector.get(lane), second.vector.get(lane));
        edges.normal.set(lane, n0 + n1);
        edges.level[lane] = (n1 - n0).dot(edges.half.get(lane));
    }

    #[inline(always)]
    fn least(edges: &Edges, lane: usize) -> f32 {
        let (g, q) = (edges.normal.get(lane), edges.slope.get(lane));
        let sum = Symmetric(lane_of(&edges.sum, lane));
        let trace = sum.trace();
        let scale = (trace + TINY).recip();
        let to_unit = (g.dot(g) + TINY).recip();
        // The place on the plane of equal volumes that is next to the middle.
        let x0 = g * (edges.level[lane] * to_unit);
        let slope = q - sum.apply(x0);
        let there = edges.at_middle[lane] - x0.dot(q + slope);

        // Two directions in the plane, at right angles, the second along the slope; as long as keeps
        // all that follows about one.
        let across = g.cross(slope) * scale;
        let e1 = across * to_unit;
        let e2 = g.cross(e1);
        let rise = e1.dot(across);
        let m11 = e1.dot(sum.apply(e1)) * scale + PULL * e1.dot(e1);
        let (a2, long2) = (sum.apply(e2), e2.dot(e2));
        let m12 = e1.dot(a2) * scale;
        let m22 = e2.dot(a2) * scale + PULL * long2;
        let determinant = most(m11 * m22 - m12 * m12, 1e-36);
        let gain = rise * rise * m11 / determinant * trace;
        there - gain
    }

    fn onto(end0: &Vertex, end1: &Vertex) -> f32 {
        let to = end0.place() - end1.place();
        Symmetric(end1.seen.squares()).at(to)
    }

    /// Each face once.
    #[inline(always)]
    fn swept(hood: &Hood, end0: &Vertex, end1: &Vertex) -> Swept {
        let (a0, a1) = (end0.seen, end1.seen);
        let (mut both, mut less) = (a0, a1);
        both.add(&a1);
        less.take(&a0);
        let (first, last) = hood.dying();
        let mut once = both;
        for (wing, normal) in [(0, first), (hood.of_v0, last)] {
            once.take(&match hood.ghost == Some(wing) {
                true => Star::boundary(hood.along, hood.boundary_weight),
                false => Star::face(normal),
            });
        }
        let half = hood.along.as_dvec3() * 0.5;
        let (normal, level) = hood.volume((first, last));
        Swept {
            half,
            sum: matrix(&once),
            slope: matrix(&less) * half,
            at_middle: half.dot(matrix(&both) * half),
            normal,
            level,
        }
    }

    /// On the plane of equal volumes.
    #[inline(always)]
    fn best(swept: &Swept) -> DVec3 {
        let Swept { sum, slope, normal, level, .. } = *swept;
        let squared = normal.length_squared();
        if squared <= f64::MIN_POSITIVE {
            return DVec3::ZERO;
        }
        let up = normal / squared.sqrt();
        let on_plane = normal * (level / squared);
        let (e1, e2) = up.any_orthonormal_pair();
        let pull = f64::from(PULL) * swept.weight();
        let (a1, a2) = (sum * e1, sum * e2);
        let (m11, m12, m22) = (e1.dot(a1) + pull, e1.dot(a2), e2.dot(a2) + pull);
        let slope = slope - sum * on_plane;
        let (r1, r2) = (e1.dot(slope), e2.dot(slope));
        let determinant = m11 * m22 - m12 * m12;
        if determinant <= 0.0 {
            return on_plane;
        }
        on_plane
            + e1 * ((m22 * r1 - m12 * r2) / determinant)
            + e2 * ((m11 * r2 - m12 * r1) / determinant)
    }

    #[inline(always)]
    fn merge(vertices: &mut Vertices, hood: &mut Hood, _: &Swept, placed: &Placed) -> Seen {
        let mut star = hood.change();
        if hood.ghost.is_some() {
            star.add(&renew_boundary(vertices, hood, placed));
        }
        Seen { star, constant: Constant::NONE }
    }

    #[inline(always)]
    fn renew(vertex: &mut Vertex, [before, after]: [&Star; 2], _: u32) {
        vertex.seen.add(before);
        vertex.seen.add(after);
        vertex.flags.set(Flags::STALE);
    }

    #[inline(always)]
    fn lose(vertex: &mut Vertex, normal: Vec3) {
        vertex.seen.take(&Star::face(normal));
    }
}

/// Brings the boundary's part of the stars up to date; gives that of the new vertex.
#[cold]
fn renew_boundary(vertices: &mut Vertices, hood: &Hood, placed: &Placed) -> Star {
    let Ends { v0, v1, .. } = placed.ends;
    let mut sum = Star::default();
    let ends = [vertices.get(v0).place(), vertices.get(v1).place()];
    for (i, of_v1) in hood.boundary() {
        let vertex = vertices.get_mut(hood.ids[i]);
        let edge = |apex: Vec3| Star::boundary(vertex.place() - apex, hood.boundary_weight);
        let (old, new) = (edge(ends[usize::from(of_v1)]), edge(placed.place));
        vertex.seen.add(&new);
        vertex.seen.take(&old);
        sum.add(&new);
    }
    sum
}
