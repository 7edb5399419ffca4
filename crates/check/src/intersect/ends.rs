//! Where what two triangles have in common ends.

use glam::{DVec2, DVec3};

use super::exact::{open_axis, side, turn, without};
use super::meet::Triangle;

/// The least part of a triangle that a point is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum On {
    Corner(usize),
    /// The edge from this corner to the next.
    Edge(usize),
    Inside,
}

/// An end of what two triangles have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct End {
    /// On what of each.
    pub(crate) on: [On; 2],
    /// Rounded; a corner to the bit.
    pub(crate) place: DVec3,
}

impl End {
    /// What is on these parts of two triangles.
    pub(super) fn new(on: [On; 2], [a, b]: [&Triangle; 2]) -> Self {
        let place = match on {
            [On::Corner(i), _] => a[i],
            [_, On::Corner(i)] => b[i],
            // An edge may lie in the plane of the other triangle, but not both in both planes.
            [On::Edge(i), On::Edge(j)] => passing(a, i, b).unwrap_or_else(|| crossing(b, j, a)),
            [On::Edge(i), On::Inside] => crossing(a, i, b),
            [On::Inside, On::Edge(j)] => crossing(b, j, a),
            [On::Inside, On::Inside] => unreachable!("what they share ends at an edge"),
        };
        Self { on, place }
    }
}

/// Where an edge passes through the plane of another triangle; `None` where it lies in it.
fn passing(of: &Triangle, edge: usize, plane: &Triangle) -> Option<DVec3> {
    let [from, to] = [of[edge], of[(edge + 1) % 3]];
    let [up, down] = [from, to].map(|p| side(plane, p));
    (up != down).then(|| {
        let t = within(plane, [from, to], (up / (up - down)).clamp(0.0, 1.0));
        from + (to - from) * t
    })
}

/// How far along an edge is at a triangle, if not so far as it seems: of heights only the signs are
/// exact, so along an edge that almost lies in its plane they may point anywhere.
fn within(triangle: &Triangle, [from, to]: [DVec3; 2], seems: f64) -> f64 {
    let Some((axis, area)) = open_axis(triangle) else { return seems };
    let [from, to] = [from, to].map(|p| without(axis, p));
    let corners = triangle.map(|p| without(axis, p));
    (0..3).fold(seems, |t, k| {
        let part = |p: DVec2| turn(corners[k], corners[(k + 1) % 3], p) / area;
        let outside = part(from + (to - from) * t) < -OUTSIDE;
        let [start, end] = [from, to].map(part);
        if outside && start != end { (start / (start - end)).clamp(0.0, 1.0) } else { t }
    })
}

/// What is outside a triangle by less of its height may be so by rounding.
const OUTSIDE: f64 = 1e-9;

/// The same of an edge that is known to pass; its middle where rounding hides how.
fn crossing(of: &Triangle, edge: usize, plane: &Triangle) -> DVec3 {
    passing(of, edge, plane).unwrap_or_else(|| of[edge].midpoint(of[(edge + 1) % 3]))
}

impl On {
    /// The edge between two corners.
    pub(crate) fn edge(i: usize, j: usize) -> Self {
        Self::Edge(if (i + 1) % 3 == j { i } else { j })
    }
}
