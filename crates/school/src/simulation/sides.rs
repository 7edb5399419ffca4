//! The side of a mesh that a point is on, from the normal at its closest point.

use glam::DVec3;
use meshlod::mesh::{Mesh, first_near};
use meshlod::spatial::ClosestPoint;

/// Normals of faces, edges and vertices, which decide the side of a point at its closest point.
///
/// The normal of an edge is the sum of its faces', the normal of a vertex the sum weighted by their
/// angles: with these the sign is right wherever the closest point is [BA05]. Vertices at one
/// position count as one.
pub struct Sides<'m> {
    mesh: &'m Mesh,
    /// Vertex that stands for all at its position.
    unique: Vec<u32>,
    faces: Vec<DVec3>,
    /// Ends of each edge in ascending order, and the sum of its faces' normals; sorted.
    edges: Vec<([u32; 2], DVec3)>,
    vertices: Vec<DVec3>,
}

/// Barycentric coordinate below which a point is on the edge opposite to the vertex.
const ON_EDGE: f64 = 1e-9;

impl<'m> Sides<'m> {
    /// Computes the normals of a valid mesh; `None` if no face has an area.
    pub fn new(mesh: &'m Mesh) -> Option<Self> {
        let unique = first_near(&mesh.positions, 0.0);
        let faces: Vec<DVec3> = mesh
            .faces
            .iter()
            .map(|&face| {
                let [a, b, c] = mesh.triangle(face);
                (b - a).cross(c - a).normalize_or_zero()
            })
            .collect();
        if faces.iter().all(|&normal| normal == DVec3::ZERO) {
            return None;
        }
        let mut vertices = vec![DVec3::ZERO; mesh.positions.len()];
        let mut edges = Vec::with_capacity(3 * faces.len());
        for (&face, &normal) in mesh.faces.iter().zip(&faces) {
            let corners = mesh.triangle(face);
            let ends = face.map(|v| unique[v.index()]);
            for k in 0..3 {
                let [at, next, last] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
                let angle = (next - at).angle_between(last - at);
                if angle.is_finite() {
                    vertices[ends[k] as usize] += normal * angle;
                }
                edges.push((ordered([ends[k], ends[(k + 1) % 3]]), normal));
            }
        }
        edges.sort_by_key(|&(ends, _)| ends);
        edges.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
        Some(Self { mesh, unique, faces, edges, vertices })
    }

    /// Returns true if a point is behind the mesh, seen from its closest point.
    pub fn is_behind(&self, point: DVec3, closest: &ClosestPoint) -> bool {
        let foot = DVec3::from(closest.point);
        (point - foot).dot(self.normal(closest, foot)) < 0.0
    }

    fn normal(&self, closest: &ClosestPoint, foot: DVec3) -> DVec3 {
        let face = self.mesh.faces[closest.face.index()];
        let corners = self.mesh.triangle(face);
        let ends = face.map(|v| self.unique[v.index()]);
        let area = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - a).length();
        let [a, b, c] = corners;
        let whole = area(a, b, c);
        let parts = [area(foot, b, c), area(foot, c, a), area(foot, a, b)];
        let is_off = parts.map(|part| part > ON_EDGE * whole);
        match is_off.iter().filter(|&&off| off).count() {
            3 => self.faces[closest.face.index()],
            2 => {
                let opposite = is_off.iter().position(|&off| !off).unwrap_or(0);
                self.edge([ends[(opposite + 1) % 3], ends[(opposite + 2) % 3]])
            }
            _ => {
                let distance = |k: &usize| corners[*k].distance_squared(foot);
                let nearest = (0..3).min_by(|i, j| distance(i).total_cmp(&distance(j)));
                self.vertices[ends[nearest.unwrap_or(0)] as usize]
            }
        }
    }

    fn edge(&self, ends: [u32; 2]) -> DVec3 {
        let ends = ordered(ends);
        let found = self.edges.binary_search_by_key(&ends, |&(ends, _)| ends);
        found.map_or(DVec3::ZERO, |at| self.edges[at].1)
    }
}

fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
