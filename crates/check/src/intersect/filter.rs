//! Pairs of triangles that surely have no more in common than corners they share, in `f64`.

use glam::{DVec2, DVec3};

use super::exact::without;
use super::meet::Triangle;

/// Two triangles, and which corners each has alone.
pub(super) struct Pair<'a> {
    pub(super) triangles: &'a [Triangle; 2],
    pub(super) alone: [[bool; 3]; 2],
}

/// Whether a plane of one of the triangles, or a line along an edge, has all that the other has
/// alone beyond it, by more than rounding can be.
///
/// `false` says nothing.
#[inline]
pub(super) fn surely_only_share(pair: &Pair) -> bool {
    let [a, b] = pair.triangles;
    let [alone_a, alone_b] = &pair.alone;
    beyond_plane(a, b, alone_b) || beyond_plane(b, a, alone_a) || beyond_line(pair)
}

/// Whether the corners that `b` has alone are surely on one side of the plane of `a`.
#[inline]
fn beyond_plane(a: &Triangle, b: &Triangle, alone: &[bool; 3]) -> bool {
    let (u, v) = (a[1] - a[0], a[2] - a[0]);
    let normal = u.cross(v);
    let mut span = Span::EMPTY;
    let mut far = DVec3::ZERO;
    for (p, &alone) in b.iter().zip(alone) {
        let to = *p - a[0];
        far = far.max(to.abs());
        span.add(to.dot(normal), alone);
    }
    let size = u.abs().max_element() * v.abs().max_element() * far.max_element();
    span.is_beyond(DOUBT_3D * size + TINY)
}

/// Whether, seen along an axis, a line through an edge of one has the corners beyond it that the
/// other has alone, and its own third corner not.
#[cold]
fn beyond_line(pair: &Pair) -> bool {
    let [a, b] = pair.triangles;
    let normal = (a[1] - a[0]).cross(a[2] - a[0]);
    let axis = normal.abs().max_position();
    let seen = [a, b].map(|triangle| triangle.map(|p| without(axis, p)));
    [(0, 1), (1, 0)].into_iter().any(|(one, other)| {
        (0..3).any(|i| {
            let shared = [i, (i + 1) % 3].map(|corner| !pair.alone[one][corner]);
            let [from, to, own] = [i, i + 1, i + 2].map(|corner| seen[one][corner % 3]);
            // What the other shares must be on the line: at its ends.
            let on_line = pair.alone[other].iter().filter(|alone| !**alone).count();
            on_line == usize::from(shared[0]) + usize::from(shared[1])
                && beyond(from, to, own, &seen[other], &pair.alone[other])
        })
    })
}

/// Whether the corners that a triangle has alone are surely on the other side of a line than `own`.
fn beyond(from: DVec2, to: DVec2, own: DVec2, seen: &[DVec2; 3], alone: &[bool; 3]) -> bool {
    let turn = |p: DVec2| {
        let (left, right) = ((to.x - from.x) * (p.y - from.y), (to.y - from.y) * (p.x - from.x));
        (left - right, DOUBT_2D * (left.abs() + right.abs()) + TINY)
    };
    let (own, own_doubt) = turn(own);
    let mut span = Span::EMPTY;
    let mut doubt: f64 = 0.0;
    for (&p, &alone) in seen.iter().zip(alone) {
        let (height, its_doubt) = turn(p);
        span.add(height, alone);
        doubt = doubt.max(its_doubt);
    }
    own.abs() > own_doubt && span.is_beyond(doubt) && (span.least > 0.0) == (own < 0.0)
}

/// The least and the greatest of some heights; of none, the least is above.
struct Span {
    least: f64,
    greatest: f64,
}

impl Span {
    const EMPTY: Self = Self { least: f64::INFINITY, greatest: f64::NEG_INFINITY };

    #[inline]
    fn add(&mut self, height: f64, counts: bool) {
        if counts {
            self.least = self.least.min(height);
            self.greatest = self.greatest.max(height);
        }
    }

    #[inline]
    fn is_beyond(&self, doubt: f64) -> bool {
        self.least <= self.greatest && (self.least > doubt || self.greatest < -doubt)
    }
}

/// A height over a plane is off by at most 7 × 2^-53 of the sum of the six products in it [She97,
/// section 4.3], each of these at most the product of the largest components: 42 × 2^-53 of that.
/// More, because this is rounded too.
const DOUBT_3D: f64 = 64.0 / (1u64 << 53) as f64;
/// A height over a line is off by at most 3 × 2^-53 of its two products, and some.
const DOUBT_2D: f64 = 4.0 / (1u64 << 53) as f64;
/// Heights below this may have lost digits to underflow.
const TINY: f64 = 1e-290;
