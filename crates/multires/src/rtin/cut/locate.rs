//! Spatial queries on a cut by descending its triangles, without visiting the whole field.
//!
//! What a triangle is bisected into lies in the nested ball of the vertex in the middle of its
//! hypotenuse.

use glam::{DVec3, Vec3};
use meshlod_spatial::closest_point;

use super::RtinCut;
use crate::cut::Located;
use crate::level::Level;
use crate::query::{Focus, QueryError, Region};
use crate::rtin::grid::{Extent, RightTriangle, middle};
use crate::slot_mesh::SlotMesh;

/// A triangle of the cut with its closest point and the squared distance, in stored units.
struct ClosestTriangle {
    slot: u32,
    nodes: [u32; 3],
    point: DVec3,
    squared: f64,
}

impl RtinCut<'_> {
    /// Returns the triangles of the cut that intersect the region `focus`.
    ///
    /// Intersection is exact up to the rounding of positions, except for segments and frusta, which
    /// may also return triangles that only come close.
    ///
    /// Cost: proportional to the level near the focus, and to the far sides of the field if it is
    /// not a square of 2ᵏ cells.
    /// # Errors
    /// The focus is invalid.
    pub fn level_within(&self, focus: &Focus) -> Result<Level, QueryError> {
        focus.validate()?;
        let model = self.model();
        let region = Region::new(focus, model.frame());
        let (mut faces, mut stack) = (Vec::new(), Vec::from(model.grid.roots()));
        while let Some(triangle) = stack.pop() {
            if let Some(nodes) = self.front.slot(&triangle).and_then(|slot| self.triangle(slot)) {
                if region.meets_triangle(self.corners(nodes)) {
                    faces.push(nodes);
                }
                continue;
            }
            let ball = self.ball_around(&triangle);
            if ball.is_none_or(|(center, radius)| region.meets_ball(center, radius)) {
                self.descend(&triangle, |half| stack.push(half));
            }
        }
        Ok(self.level_of(faces))
    }

    /// Returns the triangle of the cut closest to a point in model units, or `None` if a coordinate
    /// is not finite.
    ///
    /// Ties, as at a corner, go to the triangle with the least nodes.
    ///
    /// Cost: proportional to the depth of the field and the vertices as close as that triangle, and
    /// to the far sides of the field if it is not a square of 2ᵏ cells.
    pub fn locate(&self, point: [f64; 3]) -> Option<Located> {
        let at = self.model().frame().local(point);
        if !at.is_finite() {
            return None;
        }
        let mut best: Option<ClosestTriangle> = None;
        // Triangles, with a lower bound of the distance to what they are bisected into.
        let mut stack = self.model().grid.roots().map(|root| (0.0, root)).to_vec();
        while let Some((bound, triangle)) = stack.pop() {
            if best.as_ref().is_some_and(|best| bound * bound > best.squared) {
                continue;
            }
            if let Some(found) = self.closest_of(&triangle, at) {
                if best.as_ref().is_none_or(|best| found.is_closer_than(best)) {
                    best = Some(found);
                }
                continue;
            }
            let known = stack.len();
            self.descend(&triangle, |half| {
                let ball = self.ball_around(&half);
                let distance =
                    |(center, radius): (DVec3, f64)| (at.distance(center) - radius).max(bound);
                stack.push((ball.map_or(bound, distance), half));
            });
            // The closest comes last and is descended first.
            stack[known..].sort_by(|a, b| b.0.total_cmp(&a.0));
        }
        best.map(|ClosestTriangle { slot, nodes, point, squared }| Located {
            slot,
            nodes,
            closest: self.model().frame().model(point),
            distance: self.model().frame().model_length(squared.sqrt()),
        })
    }

    fn closest_of(&self, triangle: &RightTriangle, at: DVec3) -> Option<ClosestTriangle> {
        let slot = self.front.slot(triangle)?;
        let nodes = self.triangle(slot)?;
        let point = closest_point(at, &self.corners(nodes));
        Some(ClosestTriangle { slot, nodes, point, squared: at.distance_squared(point) })
    }

    /// Calls `each` with the halves of a bisected triangle that meet the field.
    fn descend(&self, triangle: &RightTriangle, each: impl FnMut(RightTriangle)) {
        if !triangle.is_finest() {
            let grid = &self.model().grid;
            let halves = triangle.halves().into_iter();
            halves.filter(|half| grid.extent(half) != Extent::Outside).for_each(each);
        }
    }

    /// Returns the centre and the radius of a ball around all that a triangle is bisected into;
    /// `None` if it lies across the border, where balls do not nest.
    fn ball_around(&self, triangle: &RightTriangle) -> Option<(DVec3, f64)> {
        let model = self.model();
        let at = middle(triangle.ends);
        let is_inside = model.grid.extent(triangle) == Extent::Inside;
        let is_known = is_inside && !triangle.is_finest();
        is_known.then(|| model.nested_ball(at)).map(|ball| (ball.center, ball.radius))
    }

    fn corners(&self, nodes: [u32; 3]) -> [DVec3; 3] {
        nodes.map(|node| Vec3::from(self.model().stored_position(node)).as_dvec3())
    }
}

impl ClosestTriangle {
    fn is_closer_than(&self, other: &Self) -> bool {
        let sorted = |mut nodes: [u32; 3]| {
            nodes.sort_unstable();
            nodes
        };
        let order = self.squared.total_cmp(&other.squared);
        order.then_with(|| sorted(self.nodes).cmp(&sorted(other.nodes))).is_lt()
    }
}
