//! Triangles laid into a plane, with shadows on them, and what two of them share.

use glam::{DVec2, DVec3};

use super::enclosing_ball::EnclosingBall;

/// A triangle laid into the plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlaneTriangle {
    pub(super) corners: [PlaneCorner; 3],
    /// The weight of each corner at a place is linear: a slope, and what is there at the origin.
    pub(super) weights: [(DVec2, f64); 3],
    /// It is no triangle of the mesh: all of it stands for one open edge.
    pub(super) is_virtual: bool,
}

/// Where a vertex is laid, and what of its shadow is known.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlaneCorner {
    pub(super) node: u32,
    pub(super) at: DVec2,
    /// The shadow, about the new vertex's place.
    pub(super) center: DVec3,
    pub(super) radius: f64,
    /// Of the new vertex's shadow, which is not yet known: all or nothing.
    pub(super) share: f64,
}

/// What must hold at a corner of a piece: the shadow on the fine side is in that on the coarse side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constraint {
    /// The shadow on the fine side without what the ring gives to that on the coarse side.
    pub(super) ball: EnclosingBall,
    /// How much the new vertex's shadow counts there.
    pub(super) share: f64,
    /// The triangle on the coarse side.
    pub(super) coarse: usize,
}

/// Triangles must be wider than this part of their length in the plane. Then rounding moves nothing by
/// more than 2⁻³² of the sides.
const MIN_RELATIVE_WIDTH: f64 = 1.0 / 65536.0;

impl PlaneCorner {
    /// The middle of one or two others, laid elsewhere.
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
    /// None where it is thin or turned over.
    pub(super) fn new(corners: [PlaneCorner; 3], is_virtual: bool) -> Option<Self> {
        let [a, b, c] = corners.map(|corner| corner.at);
        let longest =
            [b - a, c - b, a - c].map(DVec2::length_squared).into_iter().fold(0.0, f64::max);
        let twice_area = (b - a).perp_dot(c - a);
        if twice_area.is_nan() || twice_area <= MIN_RELATIVE_WIDTH * longest {
            return None;
        }
        // One at a corner, none at the two others.
        let weight = |from: DVec2, to: DVec2| {
            let slope = (to - from).perp() / twice_area;
            (slope, -slope.dot(from))
        };
        Some(Self { corners, weights: [weight(b, c), weight(c, a), weight(a, b)], is_virtual })
    }

    /// The shadow at a place, as far as it is known, and how much the unknown one counts.
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

    /// Whether another lies behind one of its edges.
    fn is_apart(&self, other: &Self) -> bool {
        self.weights.iter().any(|(slope, rest)| {
            other.corners.iter().all(|corner| slope.dot(corner.at) + rest <= TOUCH_TOLERANCE)
        })
    }
}

/// What overlaps by less than this part of a triangle's width touches it only.
const TOUCH_TOLERANCE: f64 = 1e-12;

/// Three cuts make six corners of three; nine, were each corner by rounding on the other side than both
/// its neighbours.
const MAX_CORNERS: usize = 9;

/// What the corners of the piece that two triangles have in common ask for. On the piece everything is
/// linear but a distance, which is convex, so it holds all over where it holds there.
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

/// What of a convex polygon lies where a weight is positive.
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
