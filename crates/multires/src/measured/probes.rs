//! Distances of points from the input.

use glam::DVec3;
use meshlod_mesh::FaceId;
use meshlod_spatial::Bvh;

use super::CoarseFace;

/// With fewer vertices of the input at a coarse side its faces are about as large as the input's, and
/// the middles of the new edges are enough beside the crossings.
const FEW: usize = 6;
/// Points on a new edge for each square root of the number of the input's vertices at the coarse
/// side, which is about the number of input vertices along it.
const DENSITY: f64 = 0.5;
/// Part of the distance that matters from which the neighbourhood of a point is searched for a
/// greater one.
const CLOSE: f64 = 0.75;
/// Number of times that the step is halved in such a search.
const HALVINGS: usize = 4;

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

    /// Returns the greatest distance of the new node, of points along the new edges and of the
    /// middles of the new faces from the input, or anything up to `least` if it is no greater.
    /// `count` is the number of vertices of the input at the coarse side.
    pub(super) fn farthest(&mut self, coarse: &[CoarseFace], count: usize, least: f64) -> f64 {
        let CoarseFace { nodes: [node, other, _], corners: [apex, ..], .. } = coarse[0];
        let hint = self.near[other as usize];
        let (mut farthest, near) = self.distance(apex, hint, least);
        self.near[node as usize] = Some(near);
        for corner in coarse.iter().flat_map(|face| &face.nodes[1..]) {
            self.near[*corner as usize].get_or_insert(near);
        }
        let points =
            if count < FEW { 0 } else { (DENSITY * (count as f64).sqrt()).ceil() as usize };
        for &CoarseFace { corners: [_, b, c], .. } in coarse {
            let middle = self.at((apex + b + c) / 3.0, node, farthest.max(least));
            farthest = farthest.max(middle);
            if points == 0 {
                farthest = farthest.max(self.at(apex.midpoint(b), node, farthest.max(least)));
            } else {
                farthest = farthest.max(self.along([apex, b], points, near, farthest.max(least)));
            }
        }
        farthest
    }

    /// Returns the distance of a point near a node from the input, or anything up to `least` if it
    /// is no greater.
    pub(super) fn at(&self, at: DVec3, node: u32, least: f64) -> f64 {
        self.distance(at, self.near[node as usize], least).0
    }

    /// Returns the greatest distance found along an edge, first at evenly spaced points, then around
    /// the farthest of them; anything up to `least` if it is no greater.
    fn along(&self, [from, to]: [DVec3; 2], points: usize, near: FaceId, least: f64) -> f64 {
        let step = 1.0 / points as f64;
        let (mut farthest, mut at, mut hint) = (0.0, 0.0, near);
        for i in 0..points {
            let t = (i as f64 + 0.5) * step;
            let (apart, face) = self.distance(from.lerp(to, t), Some(hint), CLOSE * least);
            hint = face;
            if apart > farthest {
                (farthest, at) = (apart, t);
            }
        }
        if farthest <= CLOSE * least {
            return farthest;
        }
        let mut step = step / 2.0;
        for _ in 0..HALVINGS {
            for t in [at - step, at + step] {
                let (apart, _) = self.distance(from.lerp(to, t), Some(hint), farthest);
                if apart > farthest {
                    (farthest, at) = (apart, t);
                }
            }
            step /= 2.0;
        }
        farthest
    }

    /// Returns the distance of a point from the input with a face of it as near, or any within
    /// `enough`.
    fn distance(&self, at: DVec3, hint: Option<FaceId>, enough: f64) -> (f64, FaceId) {
        let near = self.input.near(at.to_array(), hint, [enough, f64::INFINITY]);
        let near = near.expect("there is no limit");
        (near.distance_squared.sqrt(), near.face)
    }
}
