//! End points of the line segment in which two triangles intersect.

use glam::{DVec2, DVec3};

use super::exact::{orientation, project, projection_axis, side};
use super::triangle_pair::Triangle;

/// Feature of a triangle that contains a point: the corner, edge or interior of least dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Feature {
    Corner(usize),
    /// Edge from this corner to the next.
    Edge(usize),
    Inside,
}

/// An end point of the intersection segment of two triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SegmentEnd {
    /// The feature of each of the two triangles that contains the point.
    pub(crate) on: [Feature; 2],
    /// Position of the point, rounded to `f64`; exact if it is a corner.
    pub(crate) position: DVec3,
}

impl SegmentEnd {
    /// Computes the point at the intersection of a feature of each triangle.
    pub(super) fn new(on: [Feature; 2], [a, b]: [&Triangle; 2]) -> Self {
        let position = match on {
            [Feature::Corner(i), _] => a[i],
            [_, Feature::Corner(i)] => b[i],
            // An edge may lie in the plane of the other triangle, but not both in both planes.
            [Feature::Edge(i), Feature::Edge(j)] => {
                passing(a, i, b).unwrap_or_else(|| crossing(b, j, a))
            }
            [Feature::Edge(i), Feature::Inside] => crossing(a, i, b),
            [Feature::Inside, Feature::Edge(j)] => crossing(b, j, a),
            [Feature::Inside, Feature::Inside] => unreachable!("a segment ends at an edge"),
        };
        Self { on, position }
    }
}

/// Returns the intersection of an edge with the plane of another triangle; `None` if the edge lies
/// in the plane.
fn passing(of: &Triangle, edge: usize, plane: &Triangle) -> Option<DVec3> {
    let [from, to] = [of[edge], of[(edge + 1) % 3]];
    let [up, down] = [from, to].map(|p| side(plane, p));
    (up != down).then(|| {
        let t = clamped(plane, [from, to], (up / (up - down)).clamp(0.0, 1.0));
        from + (to - from) * t
    })
}

/// Clamps the parameter of a point on an edge so that the point is inside a triangle.
///
/// Only the signs of heights over the triangle's plane are exact. For an edge that almost lies in
/// that plane, the parameter computed from the heights may be anywhere.
fn clamped(triangle: &Triangle, [from, to]: [DVec3; 2], t: f64) -> f64 {
    let Some((axis, area)) = projection_axis(triangle) else { return t };
    let [from, to] = [from, to].map(|p| project(axis, p));
    let corners = triangle.map(|p| project(axis, p));
    (0..3).fold(t, |t, k| {
        let part = |p: DVec2| orientation(corners[k], corners[(k + 1) % 3], p) / area;
        let outside = part(from + (to - from) * t) < -OUTSIDE;
        let [start, end] = [from, to].map(part);
        if outside && start != end { (start / (start - end)).clamp(0.0, 1.0) } else { t }
    })
}

/// Barycentric distance by which a point may be outside a triangle through rounding.
const OUTSIDE: f64 = 1e-9;

/// Returns the intersection of an edge with a plane that it is known to cross; the edge's midpoint
/// if rounding hides where.
fn crossing(of: &Triangle, edge: usize, plane: &Triangle) -> DVec3 {
    passing(of, edge, plane).unwrap_or_else(|| of[edge].midpoint(of[(edge + 1) % 3]))
}

impl Feature {
    /// Returns the edge between two corners of a triangle.
    pub(crate) fn edge(i: usize, j: usize) -> Self {
        Self::Edge(if (i + 1) % 3 == j { i } else { j })
    }
}
