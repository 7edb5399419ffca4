//! Closest point on a triangle, in `f64`; robust for slivers and degenerate triangles.

use glam::DVec3;

/// Triangle, given by the positions of its three corners.
pub type Triangle = [DVec3; 3];

/// Squared sine of the first corner's angle below which the normal alone is not trusted.
///
/// At a sine of 1e-6 the normal still has ten good digits.
const SLIVER: f64 = 1e-12;

/// Returns the point on the triangle closest to the point `p`.
///
/// If the projection of `p` falls inside, the result is a barycentric combination of the corners,
/// else a point on one of the edges that `p` lies beyond. Slivers, whose normal is uncertain, and
/// degenerate triangles are also tested edge by edge, so the result is always a point of the
/// triangle. A closest point that is a corner equals it bit for bit.
///
/// If s is the least sine of the angles, rounding may cost 2e-16 / s of the triangle's size and at
/// most 1e-8: a point nearer by that much may exist.
///
/// # References
/// [Eri05] section 5.1.5; differs: barycentric weights from the normal, which keep their digits in
/// narrow triangles, and edge tests where the weights are in doubt.
#[inline]
pub fn closest_point(p: DVec3, &[a, b, c]: &Triangle) -> DVec3 {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let normal = ca.cross(ab);
    // Each is proportional to the area of the part opposite the corner.
    let wa = bc.cross(p - b).dot(normal);
    let wb = ca.cross(p - c).dot(normal);
    let wc = ab.cross(p - a).dot(normal);
    let sum = wa + wb + wc;
    let inside = wa >= 0.0 && wb >= 0.0 && wc >= 0.0 && sum > 0.0;
    let sliver = normal.length_squared() <= SLIVER * ab.length_squared() * ca.length_squared();
    let projection = || a + ab * (wb / sum) - ca * (wc / sum);
    if inside && !sliver {
        return projection();
    }
    let mut nearest = Nearest { point: a, distance_squared: f64::INFINITY };
    for (weight, from, to) in [(wc, a, b), (wa, b, c), (wb, c, a)] {
        if weight < 0.0 || sliver {
            nearest.offer(p, closest_on_segment(p, from, to));
        }
    }
    if inside {
        nearest.offer(p, projection());
    }
    nearest.point
}

/// Nearest point so far.
struct Nearest {
    point: DVec3,
    distance_squared: f64,
}

impl Nearest {
    #[inline]
    fn offer(&mut self, p: DVec3, point: DVec3) {
        let distance_squared = p.distance_squared(point);
        if distance_squared < self.distance_squared {
            *self = Self { point, distance_squared };
        }
    }
}

#[inline]
fn closest_on_segment(p: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    let along = to - from;
    let (t, length_squared) = ((p - from).dot(along), along.length_squared());
    if t <= 0.0 {
        from
    } else if t >= length_squared {
        to
    } else {
        from + along * (t / length_squared)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns the distance by ternary search: the distance to a slice parallel to `bc` is a convex
    /// function of the slice's position.
    fn searched(p: DVec3, &[a, b, c]: &Triangle) -> f64 {
        let distance = |t: f64| p.distance(closest_on_segment(p, a + (b - a) * t, a + (c - a) * t));
        let (mut lo, mut hi) = (0.0, 1.0);
        for _ in 0..200 {
            let (left, right) = (lo + (hi - lo) / 3.0, hi - (hi - lo) / 3.0);
            if distance(left) < distance(right) { hi = right } else { lo = left }
        }
        [lo, hi, 0.0, 1.0].map(distance).into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Returns the distance of `q` from the triangle.
    fn off(q: DVec3, triangle: &Triangle) -> f64 {
        let apart = |from: DVec3, to: DVec3| closest_on_segment(q, from, to).distance(q);
        let [a, b, c] = *triangle;
        // The two long sides of a narrow triangle would give an inaccurate normal.
        let [short, middle, _] = sides(triangle);
        let normal = short.cross(middle).normalize_or_zero();
        let edges = apart(a, b).min(apart(b, c)).min(apart(c, a));
        (q - a).dot(normal).abs().min(edges)
    }

    /// Returns the sides, shortest first.
    fn sides(&[a, b, c]: &Triangle) -> [DVec3; 3] {
        let mut sides = [b - a, c - b, a - c];
        sides.sort_by(|u, v| u.length_squared().total_cmp(&v.length_squared()));
        sides
    }

    /// Returns the tolerated error: the narrower the triangle, the more digits are lost to the
    /// cancellation of its long sides. Without area, the edges are exact.
    fn allowance(triangle: &Triangle) -> f64 {
        let [short, middle, long] = sides(triangle);
        let sine = short.cross(middle).length() / (middle.length() * long.length());
        1e-14 + if sine > 0.0 { (f64::EPSILON / sine).min(1e-8) } else { 0.0 }
    }

    fn coordinate() -> impl Strategy<Value = f64> {
        prop_oneof![-1.0..1.0, (-2i32..3).prop_map(|x| f64::from(x) / 2.0), -1e-7..1e-7]
    }

    fn point() -> impl Strategy<Value = DVec3> {
        [coordinate(), coordinate(), coordinate()].prop_map(DVec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]

        #[test]
        fn nothing_of_the_triangle_is_nearer(p in point(), triangle in [point(), point(), point()]) {
            let q = closest_point(p, &triangle);
            prop_assert!(off(q, &triangle) < 1e-14, "{q} is not on it");
            let (found, searched) = (p.distance(q), searched(p, &triangle));
            let most = searched + allowance(&triangle);
            prop_assert!(found <= most, "{found}, but {searched} is possible");
        }

        #[test]
        fn a_corner_is_its_own_closest_point(triangle in [point(), point(), point()]) {
            for corner in triangle {
                prop_assert!(closest_point(corner, &triangle).distance(corner) < 1e-15);
            }
        }
    }

    const UNIT: Triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn each_region_has_its_answer() {
        for (p, q) in [
            ([0.25, 0.25, 3.0], [0.25, 0.25, 0.0]),
            ([-1.0, -2.0, 1.0], [0.0, 0.0, 0.0]),
            ([3.0, 0.5, 1.0], [1.0, 0.0, 0.0]),
            ([0.5, 9.0, 1.0], [0.0, 1.0, 0.0]),
            ([0.5, -1.0, 1.0], [0.5, 0.0, 0.0]),
            ([-1.0, 0.5, 1.0], [0.0, 0.5, 0.0]),
            ([1.0, 1.0, 1.0], [0.5, 0.5, 0.0]),
        ] {
            assert_eq!(closest_point(p.into(), &UNIT), q.into(), "{p:?}");
        }
    }

    #[test]
    fn beyond_an_obtuse_corner_the_far_edge_answers() {
        let obtuse = [DVec3::ZERO, DVec3::X, DVec3::new(-1.0, 0.25, 0.0)];
        let p = DVec3::new(-0.5, 0.0, 0.0);
        let q = closest_point(p, &obtuse);
        assert!((p.distance(q) - searched(p, &obtuse)).abs() < 1e-15 && q.x < -0.1);
    }

    #[test]
    fn points_and_segments_are_triangles_too() {
        let p = DVec3::new(0.25, 1.0, 0.0);
        assert_eq!(closest_point(p, &[DVec3::X; 3]), DVec3::X);
        let on_segment = DVec3::new(0.25, 0.0, 0.0);
        assert_eq!(closest_point(p, &[DVec3::ZERO, DVec3::X, DVec3::X * 0.5]), on_segment);
        assert_eq!(closest_point(p, &[DVec3::ZERO, DVec3::ZERO, DVec3::X]), on_segment);
    }
}
