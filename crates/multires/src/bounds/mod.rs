//! Proven bounds instead of estimates: the distance between the finest mesh and any cut.
//!
//! Every vertex of every level has an *enclosing ball*. It extends linearly over triangles: a point
//! of a triangle has the ball whose center and radius are interpolated from those at the corners.
//! The invariant is that each point of the current mesh is paired with points of the finest mesh
//! inside its ball, and that no point of either mesh is left without a partner. A contraction pairs
//! the points of its two sides ([`overlay`]) and finds a ball for the new vertex that contains all
//! it must. The distance that a ball reaches from its vertex is the bound.

mod enclosing_ball;
mod overlay;
mod plane_triangle;
#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};

use crate::error_kind::ErrorKind;
use crate::forest::{Forest, MonotoneErrors, Stars};
use crate::length16::Length16;
use enclosing_ball::EnclosingBall;
use overlay::{Fragment, Overlay};

impl Forest {
    /// Replaces the error of every update by a proven bound on the distance to the finest mesh.
    ///
    /// Take any cut, and let *t* be the greatest error of the updates it leaves unrefined. Every
    /// point of the cut is then within *t* of the finest mesh, and every point of the finest mesh
    /// within *t* of the cut, so *t* bounds the Hausdorff distance in both directions. The finest
    /// mesh is the stored one, which may differ from the input by the rounding of its positions to
    /// `f32`. Like estimates, bounds never grow from an update to one that depends on it. An update
    /// whose coarse side has no face left gets an infinite bound.
    ///
    /// Cost: linear in the number of updates and quadratic in the faces of each; about four times a
    /// simplification.
    /// # References
    /// [CMO97] for composing mappings from step to step; differs: sets of paired points in place of
    /// mappings, and balls that are linear on triangles in place of boxes.
    pub fn measure_bounds(&mut self) {
        let mut stars = Stars::new(self);
        let mut overlay = Overlay::default();
        let mut balls: Vec<EnclosingBall> = (0..self.vertices as u32)
            .map(|leaf| EnclosingBall::point(self.stored_point(leaf)))
            .collect();
        let mut bounds = MonotoneErrors::new(self);
        for u in 0..self.updates.len() {
            let (node, children) = (self.node(u) as u32, self.updates[u].children);
            let fine = stars.contract(children, node);
            let fragment = Fragment { fine, children, node, positions: &self.positions };
            let ball = overlay.contract(&fragment, &mut balls);
            balls.push(ball);
            let own = |node: u32| balls[node as usize].reach(self.stored_point(node));
            let reach = self.ring(u).iter().map(|&v| own(v)).fold(own(node), f64::max);
            bounds.push(self, Length16::up(reach));
        }
        self.set_errors(bounds.finish());
        self.error_kind = ErrorKind::Bound;
    }

    /// Returns the position of a node, in stored units.
    pub(crate) fn stored_point(&self, node: u32) -> DVec3 {
        Vec3::from(self.positions[node as usize]).as_dvec3()
    }
}
