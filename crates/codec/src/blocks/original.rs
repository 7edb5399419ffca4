//! The original surface of blocks, and measures of how far moved vertices leave it.

use std::collections::HashMap;

use glam::{DMat3, DVec3};
use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId};
use rayon::prelude::*;

use super::report::SurfaceChange;

/// Faces at their original positions, prepared to judge displacements.
pub(super) struct OriginalSurface {
    pub(super) places: Vec<DVec3>,
    pub(super) faces: Vec<Face>,
    /// Faces around each vertex, concatenated, and the start of each vertex's list.
    ring: Vec<u32>,
    starts: Vec<u32>,
    /// For boundary vertices, the sum of squared in-surface normals of their boundary edges.
    boundaries: HashMap<u32, DMat3>,
}

/// Face with a positive area.
pub(super) struct Face {
    pub(super) corners: [u32; 3],
    pub(super) normal: DVec3,
    pub(super) area: f64,
    /// Shortest of the three heights.
    pub(super) height: f64,
}

/// Minimum cosine between the normals of faces that count as coplanar.
const LEVEL: f64 = 0.8;
/// Faces that are summed up together.
const CHUNK: usize = 4096;
/// Limit on the faces around a neighbour that are looked at.
const WIDEST: usize = 32;

impl OriginalSurface {
    pub(super) fn new(mesh: &Mesh, ordered: &[VertexId], centre: DVec3) -> Self {
        let mut numbers = vec![0; mesh.positions.len()];
        (0..).zip(ordered).for_each(|(at, v)| numbers[v.index()] = at);
        let places: Vec<_> =
            ordered.iter().map(|v| DVec3::from(mesh.positions[v.index()]) - centre).collect();
        let face = |face: &[VertexId; 3]| Face::new(face.map(|v| numbers[v.index()]), &places);
        let mut faces: Vec<_> = mesh.faces.par_iter().filter_map(face).collect();
        // Near each other in memory if they are on the surface.
        faces.par_sort_by_key(|face| face.corners.into_iter().min());
        let mut starts = vec![0; places.len() + 1];
        faces.iter().flat_map(|face| face.corners).for_each(|v| starts[v as usize + 1] += 1);
        (0..places.len()).for_each(|v| starts[v + 1] += starts[v]);
        let mut ends = starts.clone();
        let mut ring = vec![0; 3 * faces.len()];
        for (number, face) in (0..).zip(&faces) {
            for v in face.corners {
                ring[ends[v as usize] as usize] = number;
                ends[v as usize] += 1;
            }
        }
        let boundaries = boundaries(&faces, &places);
        Self { places, faces, ring, starts, boundaries }
    }

    /// Returns the faces around a vertex.
    pub(super) fn faces_around(&self, vertex: usize) -> impl Iterator<Item = &Face> + Clone {
        self.ring(vertex).iter().map(|&face| &self.faces[face as usize])
    }

    /// Returns the indices of the faces around a vertex.
    pub(super) fn ring(&self, vertex: usize) -> &[u32] {
        &self.ring[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// Returns the vertices and their neighbours, each once.
    pub(super) fn with_neighbours(&self, vertices: impl Iterator<Item = usize>) -> Vec<usize> {
        let near = vertices.flat_map(|v| {
            self.faces_around(v).flat_map(|face| face.corners).map(|v| v as usize).chain([v])
        });
        let mut all: Vec<_> = near.collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Returns the matrix of a boundary vertex, by which moving across the boundary is judged.
    pub(super) fn boundary(&self, vertex: usize) -> Option<&DMat3> {
        self.boundaries.get(&(vertex as u32))
    }

    /// Returns the mean distance of the moved faces' points from the original planes.
    pub(super) fn error(&self, moved: &[DVec3]) -> f64 {
        let error = |face: &Face| {
            let [a, b, c] = face.corners.map(|v| face.normal.dot(moved[v as usize]));
            let corners = a.abs() + b.abs() + c.abs();
            let middles = ((a + b).abs() + (b + c).abs() + (c + a).abs()) * 0.5;
            // Strang's seven-point rule of third order.
            let mean = corners / 20.0 + middles * (2.0 / 15.0) + (a + b + c).abs() * (9.0 / 60.0);
            [face.area * mean, face.area]
        };
        // Summed in an order that does not depend on the number of threads.
        let add = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a + c, b + d];
        let sum = |faces: &[Face]| faces.iter().map(error).fold([0.0; 2], add);
        let sums: Vec<_> = self.faces.par_chunks(CHUNK).map(sum).collect();
        let [sum, area] = sums.into_iter().fold([0.0; 2], add);
        if area > 0.0 { sum / area } else { 0.0 }
    }

    /// Returns all error measures of moved vertices.
    pub(super) fn change(&self, moved: &[DVec3]) -> SurfaceChange {
        SurfaceChange {
            error_estimate: self.error(moved),
            max_estimate: self.max_deviation(moved),
            flips: self.faces.par_iter().filter(|face| self.is_flipped(face, moved)).count(),
        }
    }

    /// Returns true if a face turns by more than a right angle.
    pub(super) fn is_flipped(&self, face: &Face, moved: &[DVec3]) -> bool {
        face.is_flipped(face.corners.map(|v| self.places[v as usize] + moved[v as usize]))
    }

    /// Returns true if a vertex is certainly about as near to the faces around it as `most`: if
    /// neither it nor a neighbour moved farther, or if the faces around it, or those and the faces
    /// around its neighbours, are nearly level and it stays above and near them.
    pub(super) fn is_near(&self, vertex: usize, moved: &[DVec3], most: f64) -> bool {
        if self.is_still(vertex, moved, most) {
            return true;
        }
        if self.boundary(vertex).is_some() || self.plane_distance(vertex, moved[vertex]) > most {
            return false;
        }
        let normal = self.faces_around(vertex).map(|face| face.normal * face.area).sum::<DVec3>();
        let least = LEVEL * normal.length();
        let is_level = |face: &Face| face.normal.dot(normal) >= least;
        let height = |least: f64, face: &Face| least.min(face.height);
        let around = self.faces_around(vertex);
        if !around.clone().all(is_level) {
            return false;
        }
        let reach = around.clone().fold(f64::INFINITY, height);
        let length = moved[vertex].length();
        if length <= reach || around.clone().any(|face| self.is_over(face, vertex, moved[vertex])) {
            return true;
        }
        let beside = |face: &Face| face.corners.into_iter().filter(|&v| v as usize != vertex);
        let mut wide = around.flat_map(beside).map(|v| v as usize);
        let place = self.places[vertex] + moved[vertex];
        length <= 2.0 * reach
            && wide.all(|v| {
                let is_over = |face: &Face| {
                    let away = place - self.places[face.corners[0] as usize];
                    is_level(face) && face.height >= reach && face.normal.dot(away).abs() <= most
                };
                self.boundary(v).is_none()
                    && self.ring(v).len() <= WIDEST
                    && self.faces_around(v).all(is_over)
            })
    }

    /// Returns true if a moved corner of a face is above or below the face.
    fn is_over(&self, face: &Face, vertex: usize, moved: DVec3) -> bool {
        let first = face.after(vertex as u32);
        let away = |v: u32| self.places[v as usize] - self.places[vertex];
        let [a, b] = [first, face.after(first)].map(away);
        let (s, t) = (face.normal.dot(moved.cross(b)), face.normal.dot(a.cross(moved)));
        s >= 0.0 && t >= 0.0 && s + t <= 2.0 * face.area
    }

    /// Returns the distance of a moved vertex from the planes around it, and from its boundary.
    pub(super) fn plane_distance(&self, vertex: usize, moved: DVec3) -> f64 {
        let planes =
            self.faces_around(vertex).map(|face| face.normal.dot(moved).abs()).fold(0.0, f64::max);
        let boundary = self
            .boundary(vertex)
            .map_or(0.0, |boundary| moved.dot(*boundary * moved).max(0.0).sqrt());
        planes.max(boundary)
    }

    /// Returns the sum of squared normals around vertices, by area: how much moving in each
    /// direction matters.
    pub(super) fn normals(&self, vertices: std::ops::Range<usize>) -> DMat3 {
        let mut sum = DMat3::ZERO;
        for face in vertices.flat_map(|v| self.faces_around(v)) {
            sum += outer(face.normal) * face.area;
        }
        sum
    }
}

impl Face {
    /// Returns the corner that follows a corner.
    pub(super) fn after(&self, corner: u32) -> u32 {
        let [a, b, c] = self.corners;
        if corner == a {
            b
        } else if corner == b {
            c
        } else {
            a
        }
    }

    /// Returns true if moved corners turn the face by more than a right angle or leave it (nearly)
    /// no area, when its orientation would be decided by rounding.
    pub(super) fn is_flipped(&self, [a, b, c]: [DVec3; 3]) -> bool {
        (b - a).cross(c - a).dot(self.normal) <= self.least_area()
    }

    /// Returns twice the area at and below which the face counts as lost.
    pub(super) fn least_area(&self) -> f64 {
        NO_AREA * self.area
    }

    fn new(corners: [u32; 3], places: &[DVec3]) -> Option<Self> {
        let [a, b, c] = corners.map(|v| places[v as usize]);
        let double = (b - a).cross(c - a);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let area = 0.5 * double.length();
        let normal = double.try_normalize()?;
        Some(Self { corners, normal, area, height: 2.0 * area / longest })
    }
}

/// Fraction of its area below which a face counts as lost.
const NO_AREA: f64 = 1e-9;

/// Computes for each boundary vertex the sum of squared directions across its boundary edges.
fn boundaries(faces: &[Face], places: &[DVec3]) -> HashMap<u32, DMat3> {
    let triangles: Vec<_> = faces.iter().map(|face| face.corners.map(VertexId)).collect();
    let connectivity = Connectivity::new(&triangles, places.len());
    let mut boundaries = HashMap::new();
    for (number, face) in faces.iter().enumerate() {
        for k in 0..3 {
            let side = Side::new(FaceId::new(number), k);
            if connectivity.twin(side) != Twin::Boundary {
                continue;
            }
            let ends = [face.corners[k], face.corners[(k + 1) % 3]];
            let along = places[ends[1] as usize] - places[ends[0] as usize];
            let across = along.cross(face.normal).normalize_or_zero();
            for v in ends {
                *boundaries.entry(v).or_insert(DMat3::ZERO) += outer(across);
            }
        }
    }
    boundaries
}

/// Returns the outer product of a vector with itself.
pub(super) fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}
