//! Shading normals at the corners of faces.

use glam::{DVec3, Vec3};
use meshlod_mesh::{Layer, LayerKind, Mesh, VertexId, WedgeId};
use rayon::prelude::*;

use crate::Normals;
use crate::trigonometry::{cosine, rough_arc_cosine};

/// Source of the normals at a face's corners.
pub(crate) enum CornerNormals<'a> {
    Flat,
    /// Normal layer of the mesh, with its wedges.
    Layer(&'a Layer, &'a [[WedgeId; 3]]),
    /// One normal per vertex.
    Smooth(Vec<Vec3>),
    /// Computed for each visible face from the faces around its corners.
    Creased {
        rings: Rings,
        crease_cosine: f64,
    },
}

/// Faces around every vertex.
pub(crate) struct Rings {
    starts: Vec<u32>,
    faces: Vec<u32>,
}

/// Number of faces whose weights are computed in parallel before they are summed in order.
const BLOCK: usize = 1 << 15;

/// Limit on the faces around a vertex for creased normals. A vertex with more has no meaningful
/// normal, and in a fan of a million faces, visiting the whole ring for each face would take
/// quadratic time.
const MAX_AROUND: usize = 1 << 10;

impl<'a> CornerNormals<'a> {
    pub(crate) fn new(mesh: &'a Mesh, normals: Normals) -> Self {
        match normals {
            Normals::Flat => Self::Flat,
            Normals::Smooth => Self::Smooth(smooth(mesh)),
            Normals::Creased { crease_rad } => {
                Self::Creased { rings: Rings::new(mesh), crease_cosine: cosine(crease_rad) }
            }
            Normals::FromMesh => {
                let attributes = mesh.attributes.as_ref();
                let layer = attributes.and_then(|a| Some((a, a.layer(LayerKind::Normal)?)));
                match layer {
                    Some((attributes, layer)) => Self::Layer(layer, &attributes.corners),
                    None => Self::new(mesh, Normals::default()),
                }
            }
        }
    }

    /// Returns the normals at a face's corners; `flat`, the face's own, replaces missing ones.
    pub(crate) fn of(&self, mesh: &Mesh, face: usize, flat: Vec3) -> [Vec3; 3] {
        let normals = match self {
            Self::Flat => [flat; 3],
            Self::Layer(layer, corners) => corners[face].map(|w| Vec3::from_slice(layer.of(w))),
            Self::Smooth(normals) => mesh.faces[face].map(|v| normals[v.index()]),
            Self::Creased { rings, crease_cosine } => {
                mesh.faces[face].map(|v| creased(mesh, v, rings.of(v), flat, *crease_cosine))
            }
        };
        normals.map(|normal| normal.try_normalize().unwrap_or(flat))
    }
}

/// Computes the unit normals with which [`render`](crate::render()) shades the corners of every face,
/// on the side from which the corners run counter-clockwise.
///
/// A face without area has the normal +z.
///
/// Cost: O(n), n = faces; with creases, times the faces around a vertex.
pub fn corner_normals(mesh: &Mesh, normals: Normals) -> Vec<[[f32; 3]; 3]> {
    let corners = CornerNormals::new(mesh, normals);
    let of = |(face, vertices): (usize, &[VertexId; 3])| {
        let flat = face_normal(mesh.triangle(*vertices)).unwrap_or(DVec3::Z).as_vec3();
        corners.of(mesh, face, flat).map(Vec3::into)
    };
    mesh.faces.par_iter().enumerate().map(of).collect()
}

/// Returns the unit normal of a face, or `None` if it has no area.
pub(crate) fn face_normal(corners: [DVec3; 3]) -> Option<DVec3> {
    let [a, b, c] = corners;
    // Edges are scaled first, so that the squares of tiny or huge faces stay in range.
    let (ab, ac) = (b - a, c - a);
    let scale = ab.abs().max(ac.abs()).max_element();
    (ab / scale).cross(ac / scale).try_normalize()
}

/// Sums the face normals around each vertex, weighted by the angle of the face there ([TW98]).
fn smooth(mesh: &Mesh) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; mesh.positions.len()];
    let mut weighted = Vec::new();
    for block in mesh.faces.chunks(BLOCK) {
        block
            .par_iter()
            .map(|&face| weighted_normals(mesh.triangle(face)))
            .collect_into_vec(&mut weighted);
        for (face, weighted) in block.iter().zip(&weighted) {
            for (v, normal) in face.iter().zip(weighted) {
                normals[v.index()] += *normal;
            }
        }
    }
    normals
}

/// Returns the normal of a triangle times its angle at each corner.
fn weighted_normals(corners: [DVec3; 3]) -> [Vec3; 3] {
    let Some(normal) = face_normal(corners) else { return [Vec3::ZERO; 3] };
    [0, 1, 2].map(|i| (normal * angle(corners, i)).as_vec3())
}

/// Returns the angle of a triangle at a corner, in radians.
fn angle(corners: [DVec3; 3], at: usize) -> f64 {
    let side = |to: usize| (corners[to % 3] - corners[at]).normalize_or_zero();
    rough_arc_cosine(side(at + 1).dot(side(at + 2)))
}

/// Computes the normal at vertex `v` of a face with normal `flat`, from those faces around `v`
/// whose normals deviate from it by no more than the crease angle.
fn creased(mesh: &Mesh, v: VertexId, ring: &[u32], flat: Vec3, crease_cosine: f64) -> Vec3 {
    if ring.len() > MAX_AROUND {
        return flat;
    }
    let flat = flat.as_dvec3();
    let mut sum = DVec3::ZERO;
    for &face in ring {
        let face = mesh.faces[face as usize];
        let corners = mesh.triangle(face);
        let Some(normal) = face_normal(corners) else { continue };
        if normal.dot(flat) >= crease_cosine {
            let at = face.iter().position(|&corner| corner == v).unwrap_or(0);
            sum += normal * angle(corners, at);
        }
    }
    sum.as_vec3()
}

impl Rings {
    fn new(mesh: &Mesh) -> Self {
        let mut starts = vec![0; mesh.positions.len() + 1];
        for v in mesh.faces.iter().flatten() {
            starts[v.index() + 1] += 1;
        }
        for v in 0..mesh.positions.len() {
            starts[v + 1] += starts[v];
        }
        let mut next = starts.clone();
        let mut faces = vec![0; 3 * mesh.faces.len()];
        for (face, corners) in mesh.faces.iter().enumerate() {
            for v in corners {
                faces[next[v.index()] as usize] = face as u32;
                next[v.index()] += 1;
            }
        }
        Self { starts, faces }
    }

    fn of(&self, v: VertexId) -> &[u32] {
        &self.faces[self.starts[v.index()] as usize..self.starts[v.index() + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{roof, sheet};

    fn corner_normals(mesh: &Mesh, normals: Normals, face: usize) -> [Vec3; 3] {
        super::corner_normals(mesh, normals)[face].map(Vec3::from)
    }

    #[test]
    fn a_crease_parts_normals_only_where_the_surface_bends_more() {
        // Two squares that meet at a right angle in the ridge v0 v1.
        let mesh = roof();
        let flat = corner_normals(&mesh, Normals::Flat, 0);
        let bent = corner_normals(&mesh, Normals::Creased { crease_rad: 1.0 }, 0);
        assert!((0..3).all(|i| flat[i].dot(bent[i]) > 0.999_99), "{flat:?} {bent:?}");
        let round = corner_normals(&mesh, Normals::Creased { crease_rad: 1.7 }, 0);
        let smooth = corner_normals(&mesh, Normals::Smooth, 0);
        assert!((0..3).all(|i| smooth[i].dot(round[i]) > 0.999_99), "{smooth:?} {round:?}");
        assert!(smooth[0].dot(Vec3::Y) > 0.999, "the ridge points up: {smooth:?}");
    }

    #[test]
    fn angles_weigh_and_not_the_number_of_faces() {
        // One side of the roof is two triangles at v0, the other is one: still straight up.
        let ridge = corner_normals(&roof(), Normals::Smooth, 0)[0];
        assert!((ridge - Vec3::Y).length() < 1e-3, "{ridge}");
    }

    #[test]
    fn broken_normals_of_a_file_give_way_to_the_faces() {
        let mut mesh = sheet(1);
        let corners = mesh.faces.iter().map(|f| f.map(|v| WedgeId(v.0))).collect();
        let values = [[f32::NAN; 3], [0.0; 3], [0.0, 3.0, 4.0], [f32::INFINITY; 3]].concat();
        let layer = Layer { kind: LayerKind::Normal, name: String::new(), width: 3, values };
        let attributes = meshlod_mesh::Attributes { corners, wedge_count: 4, layers: vec![layer] };
        mesh.attributes = Some(attributes);
        let normals = corner_normals(&mesh, Normals::FromMesh, 0);
        let expected =
            mesh.faces[0].map(|v| if v.0 == 2 { Vec3::new(0.0, 0.6, 0.8) } else { Vec3::Z });
        assert_eq!(normals, expected);
    }

    #[test]
    fn faces_of_any_size_have_normals() {
        for size in [1e-200, 1.0, 1e200] {
            let corners = [DVec3::ZERO, DVec3::X * size, DVec3::Y * size];
            assert_eq!(face_normal(corners), Some(DVec3::Z));
        }
        assert_eq!(face_normal([DVec3::ONE; 3]), None);
        assert_eq!(face_normal([DVec3::ZERO, DVec3::X, DVec3::X * 2.0]), None);
    }
}
