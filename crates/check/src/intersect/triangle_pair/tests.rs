//! Compares triangle intersection with an oracle in integers.

use glam::DVec3;

use super::{Triangle, intersect};
use crate::IntersectionKind;
use crate::intersect::exact::projection_axis;
use crate::intersect::filter::{Pair, surely_only_share};
use crate::intersect::tests::Random;

/// A rational point with a common positive denominator.
#[derive(Clone, Copy)]
struct Ratio {
    over: [i128; 3],
    under: i128,
}

type Whole = [[i128; 3]; 3];

fn minus(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

fn dot(a: [i128; 3], b: [i128; 3]) -> i128 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

impl Ratio {
    fn new(over: [i128; 3], under: i128) -> Self {
        if under < 0 {
            Self { over: over.map(|x| -x), under: -under }
        } else {
            Self { over, under }
        }
    }

    /// Returns the vector from an integer point, times the denominator.
    fn from(&self, a: [i128; 3]) -> [i128; 3] {
        minus(self.over, a.map(|x| x * self.under))
    }

    fn same(&self, other: &Self) -> bool {
        (0..3).all(|i| self.over[i] * other.under == other.over[i] * self.under)
    }

    fn middle(&self, other: &Self) -> Self {
        let over = |i: usize| self.over[i] * other.under + other.over[i] * self.under;
        Self::new(std::array::from_fn(over), 2 * self.under * other.under)
    }

    fn place(&self) -> DVec3 {
        DVec3::from(self.over.map(|x| x as f64)) / self.under as f64
    }
}

/// Locates a point relative to a triangle: positive inside, 0 on the boundary, negative outside.
fn depth_in(p: &Ratio, t: &Whole) -> i128 {
    let normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
    if dot(p.from(t[0]), normal) != 0 {
        return -1;
    }
    let along = |i: usize| dot(cross(minus(t[(i + 1) % 3], t[i]), p.from(t[i])), normal);
    (0..3).map(along).min().unwrap()
}

/// Returns the single point where two edges cross, if any.
fn edges_cross(p: [i128; 3], q: [i128; 3], r: [i128; 3], s: [i128; 3]) -> Option<Ratio> {
    let (u, v, w) = (minus(q, p), minus(s, r), minus(r, p));
    let n = cross(u, v);
    let nn = dot(n, n);
    if nn == 0 || dot(w, n) != 0 {
        return None;
    }
    let (t, k) = (dot(cross(w, v), n), dot(cross(w, u), n));
    let over = |i: usize| p[i] * nn + u[i] * t;
    ((0..=nn).contains(&t) && (0..=nn).contains(&k))
        .then(|| Ratio::new(std::array::from_fn(over), nn))
}

/// Returns the point where an edge pierces the plane of a triangle.
fn pierces(p: [i128; 3], q: [i128; 3], t: &Whole) -> Option<Ratio> {
    let normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
    let (at_p, at_q) = (dot(minus(p, t[0]), normal), dot(minus(q, t[0]), normal));
    let over = |i: usize| q[i] * at_p - p[i] * at_q;
    (at_p.signum() * at_q.signum() < 0).then(|| Ratio::new(std::array::from_fn(over), at_p - at_q))
}

/// Returns the kind of the intersection of two triangles and its corners, possibly with more of its
/// points.
fn oracle(a: &Whole, b: &Whole) -> Option<(IntersectionKind, Vec<Ratio>)> {
    let mut points: Vec<Ratio> = a.iter().chain(b).map(|&p| Ratio::new(p, 1)).collect();
    let edges = |t: &Whole| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    for [p, q] in edges(a) {
        points.extend(pierces(p, q, b));
        points.extend(edges(b).iter().filter_map(|&[r, s]| edges_cross(p, q, r, s)));
    }
    for [p, q] in edges(b) {
        points.extend(pierces(p, q, a));
    }
    points.retain(|p| depth_in(p, a) >= 0 && depth_in(p, b) >= 0);
    let &first = points.first()?;
    let Some(&second) = points.iter().find(|p| !p.same(&first)) else {
        return Some((IntersectionKind::Point, points));
    };
    let way = |p: &Ratio| minus(p.over.map(|x| x * first.under), first.over.map(|x| x * p.under));
    let flat = points.iter().all(|p| cross(way(p), way(&second)) == [0; 3]);
    let ends = points.iter().flat_map(|p| points.iter().map(move |q| p.middle(q)));
    let inside = ends.into_iter().any(|p| depth_in(&p, a) > 0 && depth_in(&p, b) > 0);
    let kind = match (flat, inside) {
        (false, _) => IntersectionKind::Overlap,
        (true, true) => IntersectionKind::Crossing,
        (true, false) => IntersectionKind::Segment,
    };
    Some((kind, points))
}

/// Returns a triangle of nonzero area on grid points.
fn triangle(random: &mut Random, grid: [u64; 3]) -> Whole {
    loop {
        let t: Whole = std::array::from_fn(|_| grid.map(|n| random.below(n) as i128));
        if cross(minus(t[1], t[0]), minus(t[2], t[0])) != [0; 3] {
            return t;
        }
    }
}

fn float(t: &Whole) -> Triangle {
    t.map(|p| DVec3::from(p.map(|x| x as f64)))
}

/// Returns true if a point is in the bounding box of some points, up to rounding.
fn in_box(place: DVec3, points: &[Ratio]) -> bool {
    let places = points.iter().map(Ratio::place);
    let lo = places.clone().fold(DVec3::INFINITY, DVec3::min) - 1e-12;
    let hi = places.fold(DVec3::NEG_INFINITY, DVec3::max) + 1e-12;
    place.cmpge(lo).all() && place.cmple(hi).all()
}

fn compare(a: &Whole, b: &Whole) {
    let expected = oracle(a, b);
    let found = intersect(&float(a), &float(b));
    let kind = expected.as_ref().map(|(kind, _)| *kind);
    assert_eq!(found.map(|found| found.kind), kind, "{a:?} and {b:?}");
    if let (Some(found), Some((kind, points))) = (found, expected) {
        assert!(in_box(found.point.into(), &points), "{a:?} and {b:?} at {:?}", found.point);
        assert_eq!(found.depth > 0.0, kind == IntersectionKind::Crossing, "{a:?} and {b:?}");
    }
    let unshared = [a.map(|p| !b.contains(&p)), b.map(|p| !a.contains(&p))];
    let pair = Pair { triangles: &[float(a), float(b)], unshared };
    if surely_only_share(&pair) {
        let most = match unshared[0].iter().filter(|unshared| **unshared).count() {
            3 => None,
            2 => Some(IntersectionKind::Point),
            _ => Some(IntersectionKind::Segment),
        };
        assert!(kind <= most, "{a:?} and {b:?}");
    }
}

#[test]
fn small_triangles_intersect_as_in_the_oracle() {
    let mut random = Random(1);
    for grid in [[2, 2, 2], [3, 3, 3], [4, 4, 4], [4, 4, 1], [1, 5, 5], [3, 1, 3], [7, 7, 2]] {
        for _ in 0..8000 {
            let (a, b) = (triangle(&mut random, grid), triangle(&mut random, grid));
            compare(&a, &b);
        }
    }
}

#[test]
fn all_kinds_occur() {
    let mut random = Random(2);
    let mut met = [0; 5];
    for _ in 0..2000 {
        let (a, b) = (triangle(&mut random, [3; 3]), triangle(&mut random, [3; 3]));
        met[oracle(&a, &b).map_or(4, |(kind, _)| kind as usize)] += 1;
    }
    assert!(met.iter().all(|&count| count > 10), "{met:?}");
}

#[test]
fn far_from_the_origin_nothing_changes() {
    let mut random = Random(3);
    let far = [9_007_199_254_740_000, -4_503_599_627_370_000, 1];
    for _ in 0..4000 {
        let [a, b] = [0, 1].map(|_| triangle(&mut random, [4; 3]));
        let moved = |t: &Whole| float(&t.map(|p| std::array::from_fn(|i| p[i] + far[i])));
        let expected = oracle(&a, &b).map(|(kind, _)| kind);
        assert_eq!(intersect(&moved(&a), &moved(&b)).map(|found| found.kind), expected);
    }
}

#[test]
fn a_triangle_of_zero_area_intersects_nothing_and_does_not_panic() {
    let mut random = Random(4);
    for _ in 0..3000 {
        let a: Triangle = float(&std::array::from_fn(|_| [2; 3].map(|n| random.below(n) as i128)));
        let b: Triangle = float(&std::array::from_fn(|_| [2; 3].map(|n| random.below(n) as i128)));
        if projection_axis(&a).is_none() && projection_axis(&b).is_none() {
            assert_eq!(intersect(&a, &b), None);
        } else {
            intersect(&a, &b);
        }
    }
}
