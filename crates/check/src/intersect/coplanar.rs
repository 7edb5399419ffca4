//! Intersection of two coplanar triangles.

use glam::{DVec2, DVec3};

use super::exact::{orientation, project, projection_axis};
use super::triangle_pair::Triangle;
use crate::{Intersection, IntersectionKind};

/// Intersects two coplanar triangles; `None` if they do not touch or if one has zero area.
///
/// Works in a projection along a coordinate axis, in which all orientations are exact.
pub(super) fn intersect(a: &Triangle, b: &Triangle) -> Option<Intersection> {
    let (axis, _) = projection_axis(a)?;
    let (a, b) = (Projected::of(a, axis)?, Projected::of(b, axis)?);
    // Two convex shapes do not overlap if an edge of one has the other beyond it.
    for (one, other) in [(&a, &b), (&b, &a)] {
        for i in 0..3 {
            let (from, to) = (one.projected[i], one.projected[(i + 1) % 3]);
            let sides = other.projected.map(|p| orientation(from, to, p));
            if sides.iter().all(|&side| side <= 0.0) {
                let edge = [one.corners[i], one.corners[(i + 1) % 3]];
                return on_line(edge, &other.corners, sides);
            }
        }
    }
    Some(Intersection {
        kind: IntersectionKind::Overlap,
        point: inside_both(&a, &b).into(),
        depth: 0.0,
    })
}

/// A triangle and its projection along an axis, counter-clockwise.
struct Projected {
    corners: Triangle,
    projected: [DVec2; 3],
}

impl Projected {
    fn of(triangle: &Triangle, axis: usize) -> Option<Self> {
        let [a, b, c] = *triangle;
        let sign = orientation(project(axis, a), project(axis, b), project(axis, c));
        let corners = if sign < 0.0 { [a, c, b] } else { [a, b, c] };
        (sign != 0.0).then(|| Self { corners, projected: corners.map(|p| project(axis, p)) })
    }

    fn contains(&self, p: DVec2) -> bool {
        (0..3).all(|i| orientation(self.projected[i], self.projected[(i + 1) % 3], p) >= 0.0)
    }
}

/// Intersects an edge with a triangle that lies beyond the edge's line or touches it.
fn on_line(edge: [DVec3; 2], other: &Triangle, sides: [f64; 3]) -> Option<Intersection> {
    let touching = || other.iter().zip(sides).filter(|&(_, side)| side == 0.0).map(|(&p, _)| p);
    let least = |p: DVec3, q: DVec3| if before(p, q) { p } else { q };
    let greatest = |p: DVec3, q: DVec3| if before(p, q) { q } else { p };
    let start = greatest(least(edge[0], edge[1]), touching().reduce(least)?);
    let end = least(greatest(edge[0], edge[1]), touching().reduce(greatest)?);
    let (kind, point) = if start == end {
        (IntersectionKind::Point, start)
    } else if before(start, end) {
        (IntersectionKind::Segment, (start + end) * 0.5)
    } else {
        return None;
    };
    Some(Intersection { kind, point: point.into(), depth: 0.0 })
}

/// Orders points lexicographically, which is monotone along every line.
fn before(p: DVec3, q: DVec3) -> bool {
    p.to_array() < q.to_array()
}

/// Returns the mean of the corners of the intersection polygon of two overlapping triangles.
fn inside_both(a: &Projected, b: &Projected) -> DVec3 {
    let mut sum = DVec3::ZERO;
    let mut count = 0.0;
    let mut add = |p: DVec3| {
        sum += p;
        count += 1.0;
    };
    for (one, other) in [(a, b), (b, a)] {
        for (i, &p) in one.projected.iter().enumerate() {
            if other.contains(p) {
                add(one.corners[i]);
            }
        }
    }
    for i in 0..3 {
        let (from, to) = (a.projected[i], a.projected[(i + 1) % 3]);
        for j in 0..3 {
            let (p, q) = (b.projected[j], b.projected[(j + 1) % 3]);
            let (at_p, at_q) = (orientation(from, to, p), orientation(from, to, q));
            let crosses =
                opposite(at_p, at_q) && opposite(orientation(p, q, from), orientation(p, q, to));
            if crosses {
                let along = at_p / (at_p - at_q);
                add(b.corners[j] + (b.corners[(j + 1) % 3] - b.corners[j]) * along);
            }
        }
    }
    sum / count
}

fn opposite(x: f64, y: f64) -> bool {
    (x < 0.0 && y > 0.0) || (x > 0.0 && y < 0.0)
}
