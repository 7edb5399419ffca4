//! Floating-point filter: proves in `f64` that two triangles have nothing in common beyond shared
//! corners.

use glam::{DVec2, DVec3};

use super::exact::project;
use super::triangle_pair::Triangle;

/// Two triangles with a flag per corner, true if the other triangle does not share it.
pub(super) struct Pair<'a> {
    pub(super) triangles: &'a [Triangle; 2],
    pub(super) unshared: [[bool; 3]; 2],
}

/// Returns true if the plane of one triangle, or a line through one of its edges, separates it from
/// the unshared corners of the other by more than the rounding error.
///
/// `false` leaves the question open.
#[inline]
pub(super) fn surely_only_share(pair: &Pair) -> bool {
    let [a, b] = pair.triangles;
    let [unshared_a, unshared_b] = &pair.unshared;
    beyond_plane(a, b, unshared_b) || beyond_plane(b, a, unshared_a) || beyond_line(pair)
}

/// Returns true if the unshared corners of `b` are surely on one side of the plane of `a`.
#[inline]
fn beyond_plane(a: &Triangle, b: &Triangle, unshared: &[bool; 3]) -> bool {
    let (u, v) = (a[1] - a[0], a[2] - a[0]);
    let normal = u.cross(v);
    let mut heights = Interval::EMPTY;
    let mut far = DVec3::ZERO;
    for (p, &unshared) in b.iter().zip(unshared) {
        let to = *p - a[0];
        far = far.max(to.abs());
        heights.add(to.dot(normal), unshared);
    }
    let size = u.abs().max_element() * v.abs().max_element() * far.max_element();
    heights.excludes_zero(ERROR_3D * size + TINY)
}

/// Returns true if, in the projection along an axis, a line through an edge of one triangle
/// separates its third corner from the unshared corners of the other.
#[cold]
fn beyond_line(pair: &Pair) -> bool {
    let [a, b] = pair.triangles;
    let normal = (a[1] - a[0]).cross(a[2] - a[0]);
    let axis = normal.abs().max_position();
    let projected = [a, b].map(|triangle| triangle.map(|p| project(axis, p)));
    [(0, 1), (1, 0)].into_iter().any(|(one, other)| {
        (0..3).any(|i| {
            let shared = [i, (i + 1) % 3].map(|corner| !pair.unshared[one][corner]);
            let [from, to, own] = [i, i + 1, i + 2].map(|corner| projected[one][corner % 3]);
            // The shared corners of the other must be on the line: at its ends.
            let on_line = pair.unshared[other].iter().filter(|unshared| !**unshared).count();
            on_line == usize::from(shared[0]) + usize::from(shared[1])
                && beyond(from, to, own, &projected[other], &pair.unshared[other])
        })
    })
}

/// Returns true if the unshared corners are surely on the other side of a line than `own`.
fn beyond(from: DVec2, to: DVec2, own: DVec2, corners: &[DVec2; 3], unshared: &[bool; 3]) -> bool {
    let height = |p: DVec2| {
        let (left, right) = ((to.x - from.x) * (p.y - from.y), (to.y - from.y) * (p.x - from.x));
        (left - right, ERROR_2D * (left.abs() + right.abs()) + TINY)
    };
    let (own, own_error) = height(own);
    let mut heights = Interval::EMPTY;
    let mut error: f64 = 0.0;
    for (&p, &unshared) in corners.iter().zip(unshared) {
        let (height, its_error) = height(p);
        heights.add(height, unshared);
        error = error.max(its_error);
    }
    own.abs() > own_error && heights.excludes_zero(error) && (heights.least > 0.0) == (own < 0.0)
}

/// Interval spanned by some heights; empty if the least is above the greatest.
struct Interval {
    least: f64,
    greatest: f64,
}

impl Interval {
    const EMPTY: Self = Self { least: f64::INFINITY, greatest: f64::NEG_INFINITY };

    #[inline]
    fn add(&mut self, height: f64, counts: bool) {
        if counts {
            self.least = self.least.min(height);
            self.greatest = self.greatest.max(height);
        }
    }

    #[inline]
    fn excludes_zero(&self, error: f64) -> bool {
        self.least <= self.greatest && (self.least > error || self.greatest < -error)
    }
}

/// Relative error bound of a height over a plane: at most 7 × 2^-53 of the sum of its six products
/// [She97, section 4.3], each at most the product of the largest components, so 42 × 2^-53 of that.
/// The rest covers the rounding of the bound itself.
const ERROR_3D: f64 = 64.0 / (1u64 << 53) as f64;
/// Relative error bound of a height over a line: at most 3 × 2^-53 of its two products, and a
/// margin.
const ERROR_2D: f64 = 4.0 / (1u64 << 53) as f64;
/// Height below which digits may have been lost to underflow.
const TINY: f64 = 1e-290;
