//! Exact intersection of two triangles: every decision is the sign of a determinant that `robust`
//! computes exactly [She97].

use std::cmp::Ordering;

use glam::DVec3;

use super::coplanar;
use super::exact::side;
use super::segment_end::{Feature, SegmentEnd};
use crate::{Intersection, IntersectionKind};

/// A triangle given by its three corners.
pub(crate) type Triangle = [DVec3; 3];

/// Intersects two closed triangles, including the corners and edges they share; `None` if they are
/// disjoint.
///
/// The kind is exact wherever the signs of [`super::exact`] are. Point and depth are rounded, but a
/// point that is a corner equals it exactly. A triangle of zero area intersects nothing.
///
/// # References
/// [GD03]: two triangles that cross each other's planes cut the common line in two intervals, which
/// determinants of corners compare; differs: every sign may be zero, and the result classifies the
/// intersection.
pub(crate) fn intersect(a: &Triangle, b: &Triangle) -> Option<Intersection> {
    let heights_a = a.map(|p| side(b, p));
    if same_side(&heights_a) {
        return None;
    }
    let heights_b = b.map(|p| side(a, p));
    if same_side(&heights_b) {
        return None;
    }
    if heights_a == [0.0; 3] || heights_b == [0.0; 3] {
        return coplanar::intersect(a, b);
    }
    let (chord_a, chord_b) = (Chord::of(a, heights_a), Chord::of(b, heights_b).reversed());
    // Along the common line of both planes.
    let first = order(chord_a.end, chord_b.start);
    let last = order(chord_a.start, chord_b.end);
    match (first, last) {
        (Ordering::Less, _) | (_, Ordering::Greater) => None,
        (Ordering::Equal, _) => Some(at_point(chord_a.end, chord_b.start)),
        (_, Ordering::Equal) => Some(at_point(chord_a.start, chord_b.end)),
        _ => Some(overlap(&chord_a, &chord_b, || depth(a, heights_a, b, heights_b))),
    }
}

/// Returns the end points of the intersection of two triangles in different planes, equal if it is
/// a point; `None` if they are disjoint or coplanar.
///
/// The features of the ends are exact, as the kind of [`intersect`] is.
pub(crate) fn segment_ends(a: &Triangle, b: &Triangle) -> Option<[SegmentEnd; 2]> {
    let (heights_a, heights_b) = (a.map(|p| side(b, p)), b.map(|p| side(a, p)));
    let apart = same_side(&heights_a) || same_side(&heights_b);
    if apart || heights_a == [0.0; 3] || heights_b == [0.0; 3] {
        return None;
    }
    let (chord_a, chord_b) = (Chord::of(a, heights_a), Chord::of(b, heights_b).reversed());
    if order(chord_a.end, chord_b.start).is_lt() || order(chord_a.start, chord_b.end).is_gt() {
        return None;
    }
    let end = |of_a: PlaneCrossing, of_b: PlaneCrossing, inner: Ordering| {
        let on = match order(of_a, of_b) {
            Ordering::Equal => [of_a.on, of_b.on],
            by if by == inner => [of_a.on, chord_b.on(|of_b| order(of_a, of_b))],
            _ => [chord_a.on(|of_a| order(of_a, of_b)), of_b.on],
        };
        SegmentEnd::new(on, [a, b])
    };
    Some([
        end(chord_a.start, chord_b.start, Ordering::Greater),
        end(chord_a.end, chord_b.end, Ordering::Less),
    ])
}

/// Crossing of a triangle's boundary through the plane of another, between two corners that are not
/// both in that plane.
#[derive(Clone, Copy)]
struct PlaneCrossing {
    above: DVec3,
    below: DVec3,
    /// Parameter from `above` to `below`; exactly 0 or 1 if one of them is in the plane.
    at: f64,
    on: Feature,
}

/// Intersection of a triangle with the plane of another: a segment, or a point if both ends
/// coincide.
#[derive(Clone, Copy)]
struct Chord {
    start: PlaneCrossing,
    end: PlaneCrossing,
    /// True if the triangle has corners on both sides of the plane.
    through: bool,
    /// True if it only touches the plane with a corner.
    point: bool,
}

impl Chord {
    /// Returns the chord of a triangle whose corners have the given heights over the plane, from
    /// where its boundary rises through the plane to where it falls.
    fn of(triangle: &Triangle, heights: [f64; 3]) -> Self {
        // Without a corner below, the plane itself counts as below.
        let any_below = heights.iter().any(|&h| h < 0.0);
        let below = |i: usize| if any_below { heights[i] < 0.0 } else { heights[i] <= 0.0 };
        let crossing = |from: usize, to: usize| {
            let (i, j) = if below(from) { (to, from) } else { (from, to) };
            let at = heights[i] / (heights[i] - heights[j]);
            let on = match [heights[i] == 0.0, heights[j] == 0.0] {
                [true, _] => Feature::Corner(i),
                [_, true] => Feature::Corner(j),
                _ => Feature::edge(i, j),
            };
            PlaneCrossing { above: triangle[i], below: triangle[j], at, on }
        };
        let step = |rises: bool| {
            (0..3).map(|i| (i, (i + 1) % 3)).find(|&(i, j)| below(i) == rises && below(j) != rises)
        };
        let ends = step(true).zip(step(false));
        let (rise, fall) = ends.expect("a triangle at the plane of another is on both sides");
        Self {
            start: crossing(rise.0, rise.1),
            end: crossing(fall.0, fall.1),
            through: any_below && heights.iter().any(|&h| h > 0.0),
            point: (0..3).filter(|&i| heights[i] == 0.0).count() == 1
                && !(any_below && heights.iter().any(|&h| h > 0.0)),
        }
    }

    fn reversed(self) -> Self {
        Self { start: self.end, end: self.start, ..self }
    }

    /// Returns the feature that contains a point of the chord, given the order of the chord's ends
    /// relative to the point.
    fn on(&self, to_point: impl Fn(PlaneCrossing) -> Ordering) -> Feature {
        let at_end = [self.start, self.end].into_iter().find(|&end| to_point(end).is_eq());
        match (at_end, self.start.on, self.end.on) {
            (Some(end), ..) => end.on,
            (None, Feature::Corner(i), Feature::Corner(j)) => Feature::edge(i, j),
            _ => Feature::Inside,
        }
    }
}

impl PlaneCrossing {
    fn position(&self) -> DVec3 {
        match self.at {
            0.0 => self.above,
            1.0 => self.below,
            at => self.above + (self.below - self.above) * at,
        }
    }

    fn at_corner(&self) -> bool {
        self.at == 0.0 || self.at == 1.0
    }
}

/// Returns true if all three corners are above the plane, or all below.
fn same_side(heights: &[f64; 3]) -> bool {
    heights.iter().all(|&h| h > 0.0) || heights.iter().all(|&h| h < 0.0)
}

/// Orders a crossing of triangle a and one of triangle b along the common line, in the direction of
/// the cross product of the normals of a and b.
fn order(a: PlaneCrossing, b: PlaneCrossing) -> Ordering {
    let sign = side(&[b.above, b.below, a.above], a.below);
    // The sign says on which side the line through a's corners passes the line through b's.
    0.0.partial_cmp(&sign).unwrap_or(Ordering::Equal)
}

fn at_point(a: PlaneCrossing, b: PlaneCrossing) -> Intersection {
    let point = if a.at_corner() { a.position() } else { b.position() };
    Intersection { kind: IntersectionKind::Point, point: point.into(), depth: 0.0 }
}

/// Intersects two chords that overlap, or one of which is a point inside the other.
fn overlap(a: &Chord, b: &Chord, depth: impl FnOnce() -> f64) -> Intersection {
    let start = if order(a.start, b.start).is_lt() { b.start } else { a.start };
    let end = if order(a.end, b.end).is_gt() { b.end } else { a.end };
    if a.point || b.point {
        return at_point(if a.point { a.start } else { b.start }, start);
    }
    let point = (start.position() + end.position()) * 0.5;
    let through = a.through && b.through;
    Intersection {
        kind: if through { IntersectionKind::Crossing } else { IntersectionKind::Segment },
        point: point.into(),
        depth: if through { depth() } else { 0.0 },
    }
}

/// Returns the penetration depth: the least translation along either normal after which one
/// triangle is on one side of the other.
fn depth(a: &Triangle, heights_a: [f64; 3], b: &Triangle, heights_b: [f64; 3]) -> f64 {
    let least = |heights: [f64; 3], of: &Triangle| {
        let above = heights.iter().fold(0.0, |most: f64, &h| most.max(h));
        let below = heights.iter().fold(0.0, |most: f64, &h| most.max(-h));
        above.min(below) / (of[1] - of[0]).cross(of[2] - of[0]).length()
    };
    let depth = least(heights_a, b).min(least(heights_b, a));
    if depth.is_finite() { depth } else { 0.0 }
}

#[cfg(test)]
mod tests;
