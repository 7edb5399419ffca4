//! The face of a level nearest to a point of the input.

use glam::DVec3;
use meshlod_mesh::{Connectivity, FaceId, Mesh, VertexId};
use meshlod_spatial::{Triangle, closest_point};

use crate::kernel::mesh::vertex::NO_VERTEX;

/// Number of times that the search goes on around another vertex.
const MOST_HOPS: usize = 3;

/// A point of the input at the face of the level that is nearest to it.
pub(super) struct Hit {
    pub(super) face: u32,
    /// Weights of the face's corners at the closest point.
    pub(super) weights: [f64; 3],
    /// Distance above the face's plane.
    pub(super) height: f64,
    /// Area that the point stands for.
    pub(super) area: f64,
}

/// Search for the nearest faces.
pub(super) struct Nearest<'a> {
    faces: &'a [[VertexId; 3]],
    connectivity: &'a Connectivity,
    pub(super) triangles: Vec<Triangle>,
    /// Unit normals of the faces; zero without area.
    pub(super) normals: Vec<DVec3>,
}

impl<'a> Nearest<'a> {
    pub(super) fn new(level: &'a Mesh, connectivity: &'a Connectivity) -> Self {
        let place = |v: VertexId| DVec3::from(level.positions[v.index()]);
        let triangles: Vec<Triangle> = level.faces.iter().map(|face| face.map(place)).collect();
        let normal = |[a, b, c]: &Triangle| (b - a).cross(c - a).normalize_or_zero();
        let normals = triangles.iter().map(normal).collect();
        Self { faces: &level.faces, connectivity, triangles, normals }
    }

    /// Returns the face nearest to a point among those around vertices close to it, beginning at one
    /// of three; `None` if there is none of these.
    pub(super) fn hit(&self, point: DVec3, near: [u32; 3], area: f64) -> Option<Hit> {
        let mut from = near.into_iter().find(|&v| v != NO_VERTEX)?;
        let mut best = (f64::INFINITY, FaceId(0), DVec3::ZERO);
        let mut seen = [NO_VERTEX; MOST_HOPS];
        for hop in 0..MOST_HOPS {
            seen[hop] = from;
            for &face in self.connectivity.star(VertexId(from)) {
                self.offer(point, face, &mut best);
            }
            let (corners, weights) = (self.faces[best.1.index()], self.weights(best.1, best.2));
            let most = (0..3).max_by(|&i, &k| weights[i].total_cmp(&weights[k])).expect("three");
            let next = corners[most].0;
            if seen.contains(&next) {
                break;
            }
            from = next;
        }
        let (_, face, at) = best;
        let normal = self.normals[face.index()];
        let height = (point - at).dot(normal);
        Some(Hit { face: face.0, weights: self.weights(face, at), height, area })
    }

    /// Takes a face if it is nearer.
    #[inline]
    fn offer(&self, point: DVec3, face: FaceId, best: &mut (f64, FaceId, DVec3)) {
        let triangle = &self.triangles[face.index()];
        let above = self.normals[face.index()].dot(point - triangle[0]);
        if above * above >= best.0 {
            return;
        }
        let at = closest_point(point, triangle);
        let apart = point.distance_squared(at);
        if apart < best.0 {
            *best = (apart, face, at);
        }
    }

    /// Returns the weights of the corners at a point of a face.
    fn weights(&self, face: FaceId, at: DVec3) -> [f64; 3] {
        let ([a, b, c], normal) = (self.triangles[face.index()], self.normals[face.index()]);
        let of = |u: DVec3, v: DVec3| (u - at).cross(v - at).dot(normal).max(0.0);
        let parts = [of(b, c), of(c, a), of(a, b)];
        let sum: f64 = parts.iter().sum();
        if sum > 0.0 { parts.map(|part| part / sum) } else { [1.0 / 3.0; 3] }
    }
}
