//! Bounds instead of estimates: how far apart the finest mesh and any cut can be at most.
//!
//! Every vertex of every level has a *shadow*, a ball. A point of a triangle has one too, the mean of
//! those of the corners as the point is of the corners. At all times each point of the mesh is paired
//! with points of the finest one that lie in its shadow, and no point of either mesh is without a pair.
//! A contraction pairs the points of its two sides ([`overlay`]) and finds the new vertex a shadow that
//! holds what has to be in it. How far shadows reach is the bound.

mod enclosing_ball;
mod overlay;
mod plane_triangle;
mod stars;
#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};

use crate::forest::Forest;
use crate::frame::Length16;
use enclosing_ball::EnclosingBall;
use overlay::{Fragment, Overlay};
use stars::Stars;

/// What is known of an update's error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ErrorKind {
    /// The simplification's own estimate: most triangles are within it, some are not.
    #[default]
    Estimate,
    /// A proven bound: no triangle is further off.
    Bound,
}

impl Forest {
    /// Replaces every update's error by a bound.
    ///
    /// Then in any cut whose updates that are not made have errors of at most *t*, each point is within
    /// *t* of the finest mesh, and each point of the finest mesh within *t* of the cut: both ways of the
    /// Hausdorff distance. The finest mesh is the one that is stored, which may be off the input by the
    /// rounding of its positions to `f32`. Bounds are monotone along needs as estimates are. An update
    /// whose coarse side has no face left, if there is one, gets an infinite bound.
    ///
    /// Cost: linear, but for the faces of each side against those of the other; about four times a
    /// simplification.
    /// # References
    /// [CMO97] for mapping one step after the other; differs: pairs of points in place of maps, balls
    /// that are linear on triangles in place of boxes.
    pub fn measure_bounds(&mut self) {
        let mut stars = Stars::new(self);
        let mut overlay = Overlay::default();
        let mut shadows: Vec<EnclosingBall> =
            (0..self.vertices as u32).map(|leaf| EnclosingBall::point(self.place(leaf))).collect();
        // By node: the greatest bound of those that need its update.
        let mut asked = vec![Length16::default(); self.positions.len()];
        for u in 0..self.updates.len() {
            let (node, children) = (self.node(u) as u32, self.updates[u].children);
            let fine = stars.contract(children, node);
            let fragment = Fragment { fine, children, node, positions: &self.positions };
            let shadow = overlay.contract(&fragment, &mut shadows);
            shadows.push(shadow);
            let own = |node: u32| shadows[node as usize].reach(self.place(node));
            let reach = self.ring(u).iter().map(|&v| own(v)).fold(own(node), f64::max);
            let [a, b] = children.map(|child| asked[child as usize]);
            let error = Length16::up(reach).max(a).max(b);
            self.set_error(u, error, &mut asked);
        }
        self.error_kind = ErrorKind::Bound;
    }

    /// Where a node is, in stored units.
    fn place(&self, node: u32) -> DVec3 {
        Vec3::from(self.positions[node as usize]).as_dvec3()
    }

    /// An update's error, which all around will ask of theirs.
    fn set_error(&mut self, u: usize, error: Length16, asked: &mut [Length16]) {
        self.updates[u].error = error;
        if self.updates[u].fused_with_child {
            // One update of two contractions is needed as a whole.
            self.updates[u - 1].error = error;
        }
        asked[self.node(u)] = error;
        for &v in self.ring(u) {
            let asked = &mut asked[v as usize];
            *asked = (*asked).max(error);
        }
    }
}
