//! Where what two triangles have in common ends.

use glam::DVec3;

use super::exact::side;
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
    (up != down).then(|| from + (to - from) * (up / (up - down)).clamp(0.0, 1.0))
}

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
