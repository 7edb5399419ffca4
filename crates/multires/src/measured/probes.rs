//! Distances of points from the input.

use glam::DVec3;
use meshlod_mesh::FaceId;
use meshlod_spatial::Bvh;

use super::CoarseFace;

/// Distances of points from the input, near points that were asked for before.
#[derive(Debug)]
pub(super) struct Probes<'b> {
    input: &'b Bvh,
    /// By node: a face of the input nearby.
    near: Vec<Option<FaceId>>,
}

impl<'b> Probes<'b> {
    pub(super) fn new(input: &'b Bvh, nodes: usize) -> Self {
        Self { input, near: vec![None; nodes] }
    }

    /// Returns the greatest distance of the new node and of the middles of the new edges from the
    /// input, or anything up to `least` if it is no greater.
    pub(super) fn farthest(&mut self, coarse: &[CoarseFace], least: f64) -> f64 {
        let CoarseFace { nodes: [node, other, _], corners: [apex, ..], .. } = coarse[0];
        let hint = self.near[other as usize];
        let (mut farthest, near) = self.distance(apex, hint, least);
        self.near[node as usize] = Some(near);
        for corner in coarse.iter().flat_map(|face| &face.nodes[1..]) {
            self.near[*corner as usize].get_or_insert(near);
        }
        for &CoarseFace { corners: [own, b, _], .. } in coarse {
            if own != apex {
                // A pose may tear the node's wedges apart.
                farthest = farthest.max(self.at(own, node, farthest.max(least)));
            }
            farthest = farthest.max(self.at(own.midpoint(b), node, farthest.max(least)));
        }
        farthest
    }

    /// Returns the distance of a point near a node from the input, or anything up to `least` if it
    /// is no greater.
    fn at(&self, at: DVec3, node: u32, least: f64) -> f64 {
        self.distance(at, self.near[node as usize], least).0
    }

    /// Returns the distance of a point from the input with a face of it as near, or any within
    /// `enough`.
    fn distance(&self, at: DVec3, hint: Option<FaceId>, enough: f64) -> (f64, FaceId) {
        let near = self.input.near(at.to_array(), hint, [enough, f64::INFINITY]);
        let near = near.expect("there is no limit");
        (near.distance_squared.sqrt(), near.face)
    }
}
