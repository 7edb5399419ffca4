//! Triangles projected to the plane, the balls on them, and the intersection of two.

use glam::{DVec2, DVec3};

use super::enclosing_ball::EnclosingBall;

/// Triangle projected to the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneTriangle {
    pub(super) corners: [PlaneCorner; 3],
    /// Barycentric coordinate of each corner as a linear function: its gradient, and its value at
    /// the origin.
    pub(super) weights: [(DVec2, f64); 3],
    /// True if this is no triangle of the mesh but stands for one open edge.
    pub(super) is_virtual: bool,
}

/// Projected vertex with the known part of its ball.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlaneCorner {
    pub(super) node: u32,
    pub(super) at: DVec2,
    /// Center of the ball, relative to the position of the new vertex.
    pub(super) center: DVec3,
    pub(super) radius: f64,
    /// Weight of the new vertex's ball, which is unknown so far: 0 or 1 at a vertex.
    pub(super) share: f64,
}

/// Constraint at a corner of an intersection: the ball on the coarse side contains the one on the
/// fine side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constraint {
    /// Ball on the fine side, minus the contribution of ring vertices to the ball on the coarse
    /// side.
    pub(super) ball: EnclosingBall,
    /// Weight of the new vertex's ball at this point.
    pub(super) share: f64,
    /// Index of the triangle on the coarse side.
    pub(super) coarse: usize,
}

/// Minimum ratio of a triangle's height to its longest edge. Rounding then moves nothing by more
/// than 2⁻³² of the update's size.
const MIN_RELATIVE_WIDTH: f64 = 1.0 / 65536.0;

impl PlaneCorner {
    /// Returns the mean of one or two corners, placed elsewhere.
    pub(super) fn between(others: impl Iterator<Item = Self> + Clone, at: DVec2) -> Self {
        let part = 1.0 / others.clone().count() as f64;
        let start = Self { at, ..Self::default() };
        others.fold(start, |sum, other| Self {
            node: other.node,
            center: sum.center + part * other.center,
            radius: sum.radius + part * other.radius,
            share: sum.share + part * other.share,
            ..sum
        })
    }
}

impl PlaneTriangle {
    /// Returns `None` if the triangle is thin or flipped.
    pub(super) fn new(corners: [PlaneCorner; 3], is_virtual: bool) -> Option<Self> {
        let [a, b, c] = corners.map(|corner| corner.at);
        let longest =
            [b - a, c - b, a - c].map(DVec2::length_squared).into_iter().fold(0.0, f64::max);
        let twice_area = (b - a).perp_dot(c - a);
        if twice_area.is_nan() || twice_area <= MIN_RELATIVE_WIDTH * longest {
            return None;
        }
        // The function is 1 at one corner and 0 at the two others.
        let weight = |from: DVec2, to: DVec2| {
            let slope = (to - from).perp() / twice_area;
            (slope, -slope.dot(from))
        };
        Some(Self { corners, weights: [weight(b, c), weight(c, a), weight(a, b)], is_virtual })
    }

    /// Interpolates the known part of the ball at a point, and the weight of the unknown one.
    pub(super) fn at(&self, place: DVec2) -> (DVec3, f64, f64) {
        let mut sum = (DVec3::ZERO, 0.0, 0.0);
        for (corner, (slope, rest)) in self.corners.iter().zip(&self.weights) {
            let weight = slope.dot(place) + rest;
            sum.0 += weight * corner.center;
            sum.1 += weight * corner.radius;
            sum.2 += weight * corner.share;
        }
        sum
    }

    /// Returns true if `other` lies entirely behind one of the edges.
    fn is_apart(&self, other: &Self) -> bool {
        self.weights.iter().any(|(slope, rest)| {
            other.corners.iter().all(|corner| slope.dot(corner.at) + rest <= TOUCH_TOLERANCE)
        })
    }
}

/// Overlaps below this fraction of a triangle's height count as mere contact.
const TOUCH_TOLERANCE: f64 = 1e-12;

/// Three clips give a triangle at most six corners. Rounding could give nine, if each corner came
/// to lie on the other side than both its neighbours.
const MAX_CORNERS: usize = 9;

/// Adds the constraints at the corners of the intersection of two triangles.
///
/// Over the intersection everything is linear except for a distance, which is convex: constraints
/// that hold at the corners hold everywhere.
pub(super) fn add_constraints(
    fine: &PlaneTriangle,
    coarse: &PlaneTriangle,
    number: usize,
    constraints: &mut Vec<Constraint>,
) {
    if coarse.is_apart(fine) || fine.is_apart(coarse) {
        return;
    }
    let mut piece = [DVec2::ZERO; MAX_CORNERS];
    let mut count = 3;
    (0..3).for_each(|k| piece[k] = fine.corners[k].at);
    for line in &coarse.weights {
        (piece, count) = clip(&piece[..count], line);
    }
    for &place in &piece[..count] {
        let (center, radius, _) = fine.at(place);
        let (others, radius_of_others, share) = coarse.at(place);
        let ball = EnclosingBall { center: center - others, radius: radius - radius_of_others };
        constraints.push(Constraint { ball, share, coarse: number });
    }
}

/// Clips a convex polygon to the half-plane where a weight is positive.
fn clip(polygon: &[DVec2], (slope, rest): &(DVec2, f64)) -> ([DVec2; MAX_CORNERS], usize) {
    let (mut left, mut count) = ([DVec2::ZERO; MAX_CORNERS], 0);
    let mut keep = |corner: DVec2| {
        left[count] = corner;
        count += 1;
    };
    for (i, &from) in polygon.iter().enumerate() {
        let to = polygon[(i + 1) % polygon.len()];
        let [at_from, at_to] = [from, to].map(|place| slope.dot(place) + rest);
        if at_from >= 0.0 {
            keep(from);
        }
        if at_from * at_to < 0.0 {
            keep(from + (to - from) * (at_from / (at_from - at_to)));
        }
    }
    (left, count)
}
