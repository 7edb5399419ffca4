//! The face of a level nearest to a point of the input.

use glam::{DVec3, Mat4, Vec3, Vec4};
use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId};
use meshlod_spatial::closest_point;

use crate::kernel::mesh::local_frame::Frame;
use crate::kernel::mesh::vertex::NO_VERTEX;

/// Most faces that are crossed on the way to the nearest one.
const MOST_STEPS: usize = 8;

/// A point of the input at the face of the level that is nearest to it, in the frame.
pub(super) struct Hit {
    pub(super) face: u32,
    /// Weights of the face's corners at the closest point.
    pub(super) weights: [f32; 3],
    /// Distance above the face's plane.
    pub(super) height: f32,
    /// Area that the point stands for.
    pub(super) area: f32,
}

/// Search for the nearest faces: the best of those around a vertex, and from there across edges.
pub(super) struct NearestFaces<'a> {
    faces: &'a [[VertexId; 3]],
    connectivity: &'a Connectivity,
    places: Vec<Vec3>,
    charts: Vec<Chart>,
    /// Unit normals of the faces; zero without area.
    pub(super) normals: Vec<Vec3>,
}

/// Plane of a face with its edges, by which it tells how near a point is.
struct Chart {
    /// From a point to its distances in the plane from the lines along the edges, inwards, in the
    /// order of the opposite corners, and to its height above the plane.
    matrix: Mat4,
    /// Heights of the triangle above its edges.
    altitudes: Vec3,
}

/// A face, and a point as its chart has it.
#[derive(Clone, Copy)]
struct Found {
    face: FaceId,
    at: Vec4,
    /// Edge that the point is farthest beyond, by its opposite corner, and how far; at most 0.
    beyond: (usize, f32),
}

impl Found {
    /// Returns the square of a distance that the point has at least. It is that from the face, unless a
    /// corner is nearest.
    fn bound(&self) -> f32 {
        self.at.w * self.at.w + self.beyond.1 * self.beyond.1
    }
}

impl<'a> NearestFaces<'a> {
    pub(super) fn new(level: &'a Mesh, connectivity: &'a Connectivity, frame: Frame) -> Self {
        let places: Vec<Vec3> = level.positions.iter().map(|&at| frame.to_local(at)).collect();
        let chart = |face: &[VertexId; 3]| chart(face.map(|v| places[v.index()]));
        let (charts, normals) = level.faces.iter().map(chart).unzip();
        Self { faces: &level.faces, connectivity, places, charts, normals }
    }

    /// Returns the face nearest to a point, looked for from one of three vertices of the level on;
    /// `None` if there is none of these.
    pub(super) fn hit(&self, point: Vec3, near: [u32; 3], area: f32) -> Option<Hit> {
        let from = VertexId(near.into_iter().find(|&v| v != NO_VERTEX)?);
        let star = self.connectivity.star(from).iter();
        let mut best = star
            .map(|&face| self.find(point, face))
            .min_by(|a, b| a.bound().total_cmp(&b.bound()))?;
        for _ in 0..MOST_STEPS {
            if best.beyond.1 >= 0.0 {
                break;
            }
            let Some(face) = self.across(best.face, best.beyond.0) else { break };
            let next = self.find(point, face);
            if next.bound() >= best.bound() {
                break;
            }
            best = next;
        }
        let weights = match best.beyond.1 < 0.0 {
            true => self.weights(best.face, self.closest(point, best.face)),
            false => self.weights(best.face, point),
        };
        let sum = weights.element_sum();
        let hit =
            Hit { face: best.face.0, weights: (weights / sum).to_array(), height: best.at.w, area };
        (sum.is_finite() && sum > 0.0).then_some(hit)
    }

    #[inline]
    fn find(&self, point: Vec3, face: FaceId) -> Found {
        let at = self.charts[face.index()].matrix * point.extend(1.0);
        let mut beyond = (0, 0.0);
        for (i, inwards) in [at.x, at.y, at.z].into_iter().enumerate() {
            if inwards < beyond.1 {
                beyond = (i, inwards);
            }
        }
        Found { face, at, beyond }
    }

    /// Returns the face across the edge opposite a corner.
    fn across(&self, face: FaceId, corner: usize) -> Option<FaceId> {
        match self.connectivity.twin(Side::new(face, (corner + 1) % 3)) {
            Twin::Side(side) => Some(side.face()),
            _ => None,
        }
    }

    fn closest(&self, point: Vec3, face: FaceId) -> Vec3 {
        let corners = self.faces[face.index()].map(|v| self.places[v.index()].as_dvec3());
        closest_point(point.as_dvec3(), &corners).as_vec3()
    }

    /// Returns the weights of a face's corners below a point, which is not beyond an edge.
    fn weights(&self, face: FaceId, point: Vec3) -> Vec3 {
        let Chart { matrix, altitudes } = &self.charts[face.index()];
        ((*matrix * point.extend(1.0)).truncate() / *altitudes).max(Vec3::ZERO)
    }
}

/// Returns the chart of a triangle, and its unit normal. Without area it is far from everywhere.
fn chart(corners: [Vec3; 3]) -> (Chart, Vec3) {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let normal = (b - a).cross(c - a);
    let unit = normal / normal.length();
    let lengths = [c - b, a - c, b - a].map(DVec3::length);
    let altitudes = (normal.length() / DVec3::from(lengths)).as_vec3();
    if !(unit.is_finite() && altitudes.is_finite() && altitudes.min_element() > 0.0) {
        let matrix = Mat4::from_cols(Vec4::ZERO, Vec4::ZERO, Vec4::ZERO, Vec4::splat(f32::MAX));
        return (Chart { matrix, altitudes: Vec3::ONE }, Vec3::ZERO);
    }
    let row = |from: DVec3, to: DVec3| {
        let inwards = unit.cross((to - from).normalize());
        inwards.extend(-inwards.dot(from)).as_vec4()
    };
    let height = unit.extend(-unit.dot(a)).as_vec4();
    let matrix = Mat4::from_cols(row(b, c), row(c, a), row(a, b), height).transpose();
    (Chart { matrix, altitudes }, unit.as_vec3())
}
