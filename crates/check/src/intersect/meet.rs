//! What two triangles have in common, exactly: every decision is the sign of a determinant that
//! `robust` computes exactly [She97].

use std::cmp::Ordering;

use glam::DVec3;

use super::coplanar;
use super::ends::{End, On};
use super::exact::side;
use crate::{Touch, TouchKind};

/// Three corners, not on one line.
pub(crate) type Triangle = [DVec3; 3];

/// What the closed triangles have in common, all of it: also corners and edges that they share.
/// `None` where they are apart.
///
/// The kind is exact where the signs of [`super::exact`] are. Place and depth are rounded; a place
/// that is a corner of a triangle is that corner. A triangle without area meets nothing.
/// # References
/// [GD03]: two triangles across each other's planes cut the common line in two intervals, compared
/// by determinants of corners; differs: every sign may be zero, and the answer tells how they meet.
pub(crate) fn meet(a: &Triangle, b: &Triangle) -> Option<Touch> {
    let heights_a = a.map(|p| side(b, p));
    if same_side(&heights_a) {
        return None;
    }
    let heights_b = b.map(|p| side(a, p));
    if same_side(&heights_b) {
        return None;
    }
    if heights_a == [0.0; 3] || heights_b == [0.0; 3] {
        return coplanar::meet(a, b);
    }
    let (chord_a, chord_b) = (Chord::of(a, heights_a), Chord::of(b, heights_b).reversed());
    // Along the line that the planes have in common.
    let first = order(chord_a.end, chord_b.start);
    let last = order(chord_a.start, chord_b.end);
    match (first, last) {
        (Ordering::Less, _) | (_, Ordering::Greater) => None,
        (Ordering::Equal, _) => Some(at_point(chord_a.end, chord_b.start)),
        (_, Ordering::Equal) => Some(at_point(chord_a.start, chord_b.end)),
        _ => Some(along(&chord_a, &chord_b, || depth(a, heights_a, b, heights_b))),
    }
}

/// The ends of what two triangles in different planes have in common; one point twice where that is
/// all. `None` where they are apart, or in one plane.
///
/// What the ends are on is exact, as [`meet`] is.
pub(crate) fn ends(a: &Triangle, b: &Triangle) -> Option<[End; 2]> {
    let (heights_a, heights_b) = (a.map(|p| side(b, p)), b.map(|p| side(a, p)));
    let apart = same_side(&heights_a) || same_side(&heights_b);
    if apart || heights_a == [0.0; 3] || heights_b == [0.0; 3] {
        return None;
    }
    let (chord_a, chord_b) = (Chord::of(a, heights_a), Chord::of(b, heights_b).reversed());
    if order(chord_a.end, chord_b.start).is_lt() || order(chord_a.start, chord_b.end).is_gt() {
        return None;
    }
    let end = |of_a: Crossing, of_b: Crossing, inner: Ordering| {
        let on = match order(of_a, of_b) {
            Ordering::Equal => [of_a.on, of_b.on],
            by if by == inner => [of_a.on, chord_b.on(|of_b| order(of_a, of_b))],
            _ => [chord_a.on(|of_a| order(of_a, of_b)), of_b.on],
        };
        End::new(on, [a, b])
    };
    Some([
        end(chord_a.start, chord_b.start, Ordering::Greater),
        end(chord_a.end, chord_b.end, Ordering::Less),
    ])
}

/// Where the boundary of a triangle crosses the plane of another: between two corners, not both in
/// that plane.
#[derive(Clone, Copy)]
struct Crossing {
    above: DVec3,
    below: DVec3,
    /// The part of the way from `above` to `below`; 0 or 1 exactly where one of them is in the plane.
    at: f64,
    on: On,
}

/// What a triangle has in common with the plane of another: a segment, or a point when both ends are.
#[derive(Clone, Copy)]
struct Chord {
    start: Crossing,
    end: Crossing,
    /// Whether the triangle is on both sides of the plane.
    through: bool,
    /// Whether it only touches the plane with a corner.
    point: bool,
}

impl Chord {
    /// The chord of a triangle whose corners have these heights over the plane, from where its
    /// boundary rises through the plane to where it falls.
    fn of(triangle: &Triangle, heights: [f64; 3]) -> Self {
        // With nothing below, the plane itself counts as below.
        let any_below = heights.iter().any(|&h| h < 0.0);
        let below = |i: usize| if any_below { heights[i] < 0.0 } else { heights[i] <= 0.0 };
        let crossing = |from: usize, to: usize| {
            let (i, j) = if below(from) { (to, from) } else { (from, to) };
            let at = heights[i] / (heights[i] - heights[j]);
            let on = match [heights[i] == 0.0, heights[j] == 0.0] {
                [true, _] => On::Corner(i),
                [_, true] => On::Corner(j),
                _ => On::edge(i, j),
            };
            Crossing { above: triangle[i], below: triangle[j], at, on }
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

    /// What a point of the chord is on, by how its ends are to the point.
    fn on(&self, to_point: impl Fn(Crossing) -> Ordering) -> On {
        let at_end = [self.start, self.end].into_iter().find(|&end| to_point(end).is_eq());
        match (at_end, self.start.on, self.end.on) {
            (Some(end), ..) => end.on,
            (None, On::Corner(i), On::Corner(j)) => On::edge(i, j),
            _ => On::Inside,
        }
    }
}

impl Crossing {
    fn place(&self) -> DVec3 {
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

/// Whether all three are above the plane, or all below.
fn same_side(heights: &[f64; 3]) -> bool {
    heights.iter().all(|&h| h > 0.0) || heights.iter().all(|&h| h < 0.0)
}

/// How a crossing of triangle a and one of triangle b follow each other along the common line, in
/// the direction of the product of the normals of a and b.
fn order(a: Crossing, b: Crossing) -> Ordering {
    let sign = side(&[b.above, b.below, a.above], a.below);
    // The line from a's upper to its lower corner passes that of b on one side or the other.
    0.0.partial_cmp(&sign).unwrap_or(Ordering::Equal)
}

fn at_point(a: Crossing, b: Crossing) -> Touch {
    let place = if a.at_corner() { a.place() } else { b.place() };
    Touch { kind: TouchKind::Vertex, place: place.into(), depth: 0.0 }
}

/// The meeting of two chords that overlap, or of one with a point inside it.
fn along(a: &Chord, b: &Chord, depth: impl FnOnce() -> f64) -> Touch {
    let start = if order(a.start, b.start).is_lt() { b.start } else { a.start };
    let end = if order(a.end, b.end).is_gt() { b.end } else { a.end };
    if a.point || b.point {
        return at_point(if a.point { a.start } else { b.start }, start);
    }
    let place = (start.place() + end.place()) * 0.5;
    let through = a.through && b.through;
    Touch {
        kind: if through { TouchKind::Crossing } else { TouchKind::Edge },
        place: place.into(),
        depth: if through { depth() } else { 0.0 },
    }
}

/// The least way along either normal until one triangle is no longer on both sides of the other.
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
