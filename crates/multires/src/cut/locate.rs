//! Spatial queries on a cut by descending the nested balls, without visiting the whole mesh.
//!
//! A triangle lies in the ball of its corner of the highest level; one between leaves lies in the
//! balls of the updates that created them. Descending to every vertex whose ancestors' balls all
//! meet the target, and testing the triangles there, therefore finds all that qualify.

use glam::DVec3;
use meshlod_spatial::closest_point;

use super::Cut;
use super::front::VertexState;
use super::triangles::Spoke;
use crate::level::Level;
use crate::query::Region;
use crate::query::{Focus, QueryError};

/// The triangle of a cut that is closest to a given point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Located {
    /// Slot of the triangle in the cut's list of triangles.
    pub slot: u32,
    /// Nodes of the model at the corners of the triangle.
    pub nodes: [u32; 3],
    /// Point of the triangle that is closest to the given point, in model units.
    pub closest: [f64; 3],
    /// Distance from the given point to the triangle, in model units.
    pub distance: f64,
}

/// A triangle with its closest point and the squared distance, in stored units.
struct Candidate {
    slot: u32,
    point: DVec3,
    squared: f64,
}

impl Cut<'_> {
    /// Returns the triangles of the cut that intersect the region `focus`.
    ///
    /// Intersection is exact up to the rounding of positions, except for segments and frusta, which
    /// may also return triangles that only come close.
    ///
    /// Cost: proportional to the mesh near the focus.
    /// # Errors
    /// The focus is invalid.
    pub fn level_within(&self, focus: &Focus) -> Result<Level, QueryError> {
        focus.validate()?;
        let mt = self.front.mt;
        let region = Region::new(focus, mt.frame());
        let (mut star, mut stack) = (Vec::new(), Vec::new());
        stack.extend(mt.roots().map(|(root, _)| root));
        while let Some(node) = stack.pop() {
            let update = mt.update_of(node);
            let ball = update.map(|update| mt.ball_at(update, node));
            if ball.is_some_and(|ball| !region.meets_ball(ball.center, ball.radius)) {
                continue;
            }
            match update.filter(|_| self.front.state(node) == VertexState::Split) {
                Some(update) => stack.extend(mt.children(update)),
                None => self.front.gather(node, &mut star),
            }
        }
        let mut met: Vec<u32> = star.iter().map(Spoke::triangle).collect();
        met.sort_unstable();
        met.dedup();
        met.retain(|&t| region.meets_triangle(self.corners(self.front.triangles.nodes(t))));
        Ok(self.front.level_of(&met))
    }

    /// Returns the triangle of the cut closest to a point in model units, or `None` if the cut has
    /// no triangles or a coordinate is not finite.
    ///
    /// It contains the point if any triangle does.
    ///
    /// Ties, as at a corner, go to the triangle with the least nodes.
    ///
    /// Cost: proportional to the roots and the vertices as close as that triangle.
    pub fn locate(&self, point: [f64; 3]) -> Option<Located> {
        let mt = self.front.mt;
        let at = mt.frame().local(point);
        if !at.is_finite() {
            return None;
        }
        let mut best: Option<Candidate> = None;
        let mut star = Vec::new();
        // Nodes, with a lower bound of the distance to the triangles below them.
        let mut stack: Vec<(f64, u32)> =
            mt.roots().map(|(root, _)| (self.bound(root, at), root)).collect();
        // The closest come last and are descended first.
        stack.sort_by(|a, b| b.0.total_cmp(&a.0));
        while let Some((bound, node)) = stack.pop() {
            if best.as_ref().is_some_and(|best| bound * bound > best.squared) {
                continue;
            }
            let split = mt.update_of(node).filter(|_| self.front.state(node) == VertexState::Split);
            if let Some(update) = split {
                let mut below =
                    mt.children(update).map(|child| (bound.max(self.bound(child, at)), child));
                below.sort_by(|a, b| b.0.total_cmp(&a.0));
                stack.extend(below);
                continue;
            }
            star.clear();
            self.front.gather(node, &mut star);
            for slot in star.iter().map(Spoke::triangle) {
                let corners = self.corners(self.front.triangles.nodes(slot));
                let point = closest_point(at, &corners);
                let found = Candidate { slot, point, squared: at.distance_squared(point) };
                if best.as_ref().is_none_or(|best| self.is_closer(&found, best)) {
                    best = Some(found);
                }
            }
        }
        best.map(|Candidate { slot, point, squared }| Located {
            slot,
            nodes: self.front.triangles.nodes(slot),
            closest: mt.frame().model(point),
            distance: mt.frame().model_length(squared.sqrt()),
        })
    }

    fn is_closer(&self, one: &Candidate, other: &Candidate) -> bool {
        let sorted = |candidate: &Candidate| {
            let mut nodes = self.front.triangles.nodes(candidate.slot);
            nodes.sort_unstable();
            nodes
        };
        let order = one.squared.total_cmp(&other.squared);
        order.then_with(|| sorted(one).cmp(&sorted(other))).is_lt()
    }

    /// Returns a lower bound of the distance to a triangle whose corner of the highest level is the
    /// node or below it.
    fn bound(&self, node: u32, at: DVec3) -> f64 {
        let mt = self.front.mt;
        mt.update_of(node).map_or(0.0, |update| {
            let ball = mt.ball_at(update, node);
            (at.distance(ball.center) - ball.radius).max(0.0)
        })
    }

    fn corners(&self, nodes: [u32; 3]) -> [DVec3; 3] {
        nodes.map(|node| self.front.mt.exact_stored(node))
    }
}
