//! Distances of points of new faces from the input.

use glam::DVec3;
use meshlod_mesh::FaceId;
use meshlod_spatial::Bvh;
use rayon::prelude::*;

use super::{CoarseFace, Replayed};
use crate::forest::{Forest, NONE};

/// Distances of points from the input, near points that were asked for before.
#[derive(Debug)]
pub(super) struct Probes<'b> {
    input: &'b Bvh,
    /// By node: a face of the input nearby, or [`NONE`].
    near: Vec<u32>,
}

impl<'b> Probes<'b> {
    pub(super) fn new(input: &'b Bvh, forest: &Forest) -> Self {
        let mut near = vec![NONE; forest.positions.len()];
        for (i, face) in (0..).zip(&forest.faces) {
            face.iter().for_each(|&leaf| near[leaf as usize] = i);
        }
        Self { input, near }
    }

    /// Notes a face of the input near a node.
    pub(super) fn note(&mut self, node: usize, near: Option<FaceId>) {
        self.near[node] = near.map_or(NONE, |face| face.0);
    }

    /// Returns for each update of a block the greatest distance known of its coarse side and the
    /// input, or anything up to the least that matters if it is no greater; and a face of the input
    /// near its node.
    pub(super) fn farthest(&self, forest: &Forest, block: &Replayed) -> Vec<(f64, Option<FaceId>)> {
        let of_update = |i: usize| {
            let [apart, least] = block.apart[i];
            let hint = self.hint(forest, block.first + i);
            match block.coarse(i) {
                [] => (apart, hint),
                coarse => self.of_coarse(coarse, hint, apart.max(least)),
            }
        };
        (0..block.ends.len()).into_par_iter().map(of_update).collect()
    }

    /// Returns the greatest distance of the new node and of the middles of the new edges from the
    /// input, or anything up to `least` if it is no greater; with the face near the node.
    fn of_coarse(
        &self,
        coarse: &[CoarseFace],
        hint: Option<FaceId>,
        least: f64,
    ) -> (f64, Option<FaceId>) {
        let apex = coarse[0].corners[0];
        let (mut farthest, near) = self.distance(apex, hint, least);
        farthest = farthest.max(least);
        for &CoarseFace { corners: [own, b, _], .. } in coarse {
            if own != apex {
                // A pose may tear the node's wedges apart.
                farthest = farthest.max(self.distance(own, near, farthest).0);
            }
            farthest = farthest.max(self.distance(own.midpoint(b), near, farthest).0);
        }
        (farthest, near)
    }

    /// Returns a face of the input near an update: one that was found near the closest node below.
    fn hint(&self, forest: &Forest, u: usize) -> Option<FaceId> {
        let mut node = forest.updates[u].children[0];
        loop {
            match (self.near[node as usize], forest.update_of(node)) {
                (NONE, Some(below)) => node = forest.updates[below].children[0],
                (near, _) => return Some(near).filter(|&near| near != NONE).map(FaceId),
            }
        }
    }

    /// Returns the distance of a point from the input with a face of it as near, or any within
    /// `enough`.
    fn distance(&self, at: DVec3, hint: Option<FaceId>, enough: f64) -> (f64, Option<FaceId>) {
        let near = self.input.near(at.to_array(), hint, [enough, f64::INFINITY]);
        let near = near.expect("there is no limit");
        (near.distance_squared.sqrt(), Some(near.face))
    }
}
