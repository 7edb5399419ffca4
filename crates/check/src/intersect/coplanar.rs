//! Two triangles in one plane.

use glam::{DVec2, DVec3};

use super::exact::{open_axis, turn, without};
use super::meet::Triangle;
use crate::{Touch, TouchKind};

/// What two triangles in one plane have in common; `None` where they are apart, or one has no area.
///
/// Seen along an axis that the plane does not hold, where every turn is exact.
pub(super) fn meet(a: &Triangle, b: &Triangle) -> Option<Touch> {
    let (axis, _) = open_axis(a)?;
    let (a, b) = (Flat::of(a, axis)?, Flat::of(b, axis)?);
    // Two convex shapes do not overlap when an edge of one has the other beyond it.
    for (one, other) in [(&a, &b), (&b, &a)] {
        for i in 0..3 {
            let turns = other.seen.map(|p| turn(one.seen[i], one.seen[(i + 1) % 3], p));
            if turns.iter().all(|&turn| turn <= 0.0) {
                let edge = [one.corners[i], one.corners[(i + 1) % 3]];
                return on_line(edge, &other.corners, turns);
            }
        }
    }
    Some(Touch { kind: TouchKind::Overlap, place: inside_both(&a, &b).into(), depth: 0.0 })
}

/// A triangle, and as it is seen along an axis: counter-clockwise.
struct Flat {
    corners: Triangle,
    seen: [DVec2; 3],
}

impl Flat {
    fn of(triangle: &Triangle, axis: usize) -> Option<Self> {
        let [a, b, c] = *triangle;
        let sign = turn(without(axis, a), without(axis, b), without(axis, c));
        let corners = if sign < 0.0 { [a, c, b] } else { [a, b, c] };
        (sign != 0.0).then(|| Self { corners, seen: corners.map(|p| without(axis, p)) })
    }

    fn holds(&self, p: DVec2) -> bool {
        (0..3).all(|i| turn(self.seen[i], self.seen[(i + 1) % 3], p) >= 0.0)
    }
}

/// What an edge has in common with a triangle beyond its line.
fn on_line(edge: [DVec3; 2], other: &Triangle, turns: [f64; 3]) -> Option<Touch> {
    let touching = || other.iter().zip(turns).filter(|&(_, turn)| turn == 0.0).map(|(&p, _)| p);
    let least = |p: DVec3, q: DVec3| if before(p, q) { p } else { q };
    let greatest = |p: DVec3, q: DVec3| if before(p, q) { q } else { p };
    let start = greatest(least(edge[0], edge[1]), touching().reduce(least)?);
    let end = least(greatest(edge[0], edge[1]), touching().reduce(greatest)?);
    let (kind, place) = if start == end {
        (TouchKind::Vertex, start)
    } else if before(start, end) {
        (TouchKind::Edge, (start + end) * 0.5)
    } else {
        return None;
    };
    Some(Touch { kind, place: place.into(), depth: 0.0 })
}

/// An order of points that runs along every line.
fn before(p: DVec3, q: DVec3) -> bool {
    p.to_array() < q.to_array()
}

/// The mean of the corners of what two overlapping triangles have in common.
fn inside_both(a: &Flat, b: &Flat) -> DVec3 {
    let mut sum = DVec3::ZERO;
    let mut count = 0.0;
    let mut add = |p: DVec3| {
        sum += p;
        count += 1.0;
    };
    for (one, other) in [(a, b), (b, a)] {
        for (i, &p) in one.seen.iter().enumerate() {
            if other.holds(p) {
                add(one.corners[i]);
            }
        }
    }
    for i in 0..3 {
        let (from, to) = (a.seen[i], a.seen[(i + 1) % 3]);
        for j in 0..3 {
            let (p, q) = (b.seen[j], b.seen[(j + 1) % 3]);
            let (at_p, at_q) = (turn(from, to, p), turn(from, to, q));
            let crosses = opposite(at_p, at_q) && opposite(turn(p, q, from), turn(p, q, to));
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
