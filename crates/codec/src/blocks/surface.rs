//! The surface that vertices in blocks span, and how far it moves with them.

use std::collections::HashMap;

use glam::{DMat3, DVec3};
use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId};

use super::Change;

/// Faces by the places of their corners, with what moving them is judged by.
pub(super) struct Surface {
    pub(super) places: Vec<DVec3>,
    pub(super) faces: Vec<Face>,
    /// The faces around each vertex, and where in the list each one's start.
    ring: Vec<u32>,
    starts: Vec<u32>,
    /// Of vertices on borders: squares of directions across them, along the surface.
    rims: HashMap<u32, DMat3>,
}

/// A face that has an area.
pub(super) struct Face {
    pub(super) corners: [u32; 3],
    pub(super) normal: DVec3,
    pub(super) area: f64,
    /// The least of its heights.
    pub(super) height: f64,
}

/// The cosine up to which a face counts as level with its neighbours.
const LEVEL: f64 = 0.8;

/// Where so many faces meet, no more are looked at for each of them: else the apex of a cone takes the square of them.
const MANY: usize = 32;

impl Surface {
    pub(super) fn new(mesh: &Mesh, ordered: &[VertexId], centre: DVec3) -> Self {
        let mut numbers = vec![0; mesh.positions.len()];
        (0..).zip(ordered).for_each(|(at, v)| numbers[v.index()] = at);
        let places: Vec<_> =
            ordered.iter().map(|v| DVec3::from(mesh.positions[v.index()]) - centre).collect();
        let face = |face: &[VertexId; 3]| Face::new(face.map(|v| numbers[v.index()]), &places);
        let faces: Vec<_> = mesh.faces.iter().filter_map(face).collect();
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
        let rims = rims(&faces, &places);
        Self { places, faces, ring, starts, rims }
    }

    /// The faces around a vertex.
    pub(super) fn around(&self, vertex: usize) -> impl Iterator<Item = &Face> + Clone {
        let ring = &self.ring[self.starts[vertex] as usize..self.starts[vertex + 1] as usize];
        ring.iter().map(|&face| &self.faces[face as usize])
    }

    /// Some vertices and their neighbours, each once.
    pub(super) fn with_neighbours(&self, vertices: impl Iterator<Item = usize>) -> Vec<usize> {
        let near = vertices.flat_map(|v| {
            self.around(v).flat_map(|face| face.corners).map(|v| v as usize).chain([v])
        });
        let mut all: Vec<_> = near.collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// How much moving a vertex on a border matters; nothing anywhere else.
    pub(super) fn rim(&self, vertex: usize) -> Option<&DMat3> {
        self.rims.get(&(vertex as u32))
    }

    /// The mean distance by which points of faces leave the planes of these.
    pub(super) fn error(&self, moved: &[DVec3]) -> f64 {
        let (mut sum, mut area) = (0.0, 0.0);
        for face in &self.faces {
            let [a, b, c] = face.corners.map(|v| face.normal.dot(moved[v as usize]));
            let corners = a.abs() + b.abs() + c.abs();
            let middles = ((a + b).abs() + (b + c).abs() + (c + a).abs()) * 0.5;
            // Strang's seven points, of third order.
            let mean = corners / 20.0 + middles * (2.0 / 15.0) + (a + b + c).abs() * (9.0 / 60.0);
            sum += face.area * mean;
            area += face.area;
        }
        if area > 0.0 { sum / area } else { 0.0 }
    }

    /// All that is reported.
    pub(super) fn change(&self, moved: &[DVec3]) -> Change {
        let farther = |most: f64, v: usize| most.max(self.apart(v, moved, most));
        Change {
            error_estimate: self.error(moved),
            max_estimate: (0..self.places.len()).fold(0.0, farther),
            flips: self.faces.iter().filter(|face| self.is_flipped(face, moved)).count(),
        }
    }

    /// Whether a face is turned by more than a right angle.
    pub(super) fn is_flipped(&self, face: &Face, moved: &[DVec3]) -> bool {
        face.is_flipped(face.corners.map(|v| self.places[v as usize] + moved[v as usize]))
    }

    /// How far a vertex is from the faces around it, or points of its faces and sides, they or these moved: the greatest,
    /// if it is more than `enough`, and else nothing. Faces around its neighbours are looked at where it seems more.
    pub(super) fn apart(&self, vertex: usize, moved: &[DVec3], enough: f64) -> f64 {
        if self.around(vertex).next().is_none() {
            // Of faces without an area.
            return moved[vertex].length();
        }
        let apart = self.apart_from(self.around(vertex), vertex, moved, enough);
        if apart <= enough {
            return 0.0;
        }
        if self.around(vertex).nth(MANY).is_some() {
            return apart;
        }
        let corners = self.around(vertex).flat_map(|face| face.corners);
        let wide = corners.flat_map(|corner| self.around(corner as usize).take(MANY));
        self.apart_from(wide, vertex, moved, enough).min(apart)
    }

    fn apart_from<'f>(
        &'f self,
        faces: impl Iterator<Item = &'f Face> + Clone,
        vertex: usize,
        moved: &[DVec3],
        enough: f64,
    ) -> f64 {
        let least = enough * enough;
        let v = vertex as u32;
        // Quarters of its sides, and places in its faces.
        let points = self.around(vertex).take(MANY).flat_map(|face| {
            let (a, b) = (face.after(v), face.after(face.after(v)));
            [[v, v, v, a], [v, v, a, a], [v, a, a, a], [v, v, a, b], [v, a, a, b], [v, a, b, b]]
        });
        let apart = |of: [u32; 4]| {
            let was = of.iter().map(|&v| self.places[v as usize]).sum::<DVec3>() * 0.25;
            let by = of.iter().map(|&v| moved[v as usize]).sum::<DVec3>() * 0.25;
            // Wherever the faces are, it is no farther from where it was.
            if by.length_squared() <= least {
                return 0.0;
            }
            let is = |v: u32| self.places[v as usize] + moved[v as usize];
            let to_was = faces.clone().map(|face| face.corners.map(|v| self.places[v as usize]));
            let to_is = faces.clone().map(|face| face.corners.map(is));
            nearest(was + by, to_was, least).max(nearest(was, to_is, least))
        };
        points.chain([[v; 4]]).map(apart).fold(0.0, f64::max).sqrt()
    }

    /// Whether a vertex is surely about as near to the faces around it as that: all of them moved no farther, or they
    /// are nearly one plane, and it stays over them and near it.
    pub(super) fn is_near(&self, vertex: usize, moved: &[DVec3], most: f64) -> bool {
        let is_short = |&v: &u32| moved[v as usize].length_squared() <= most * most;
        if self.around(vertex).all(|face| face.corners.iter().all(is_short)) {
            return true;
        }
        let normal = self.around(vertex).map(|face| face.normal * face.area).sum::<DVec3>();
        let least = LEVEL * normal.length();
        let length = moved[vertex].length();
        let is_over = |face: &Face| face.normal.dot(normal) >= least && length <= face.height;
        self.rim(vertex).is_none()
            && self.around(vertex).all(is_over)
            && self.leaves(vertex, moved[vertex]) <= most
    }

    /// How far a vertex leaves the planes around it, and its borders.
    pub(super) fn leaves(&self, vertex: usize, moved: DVec3) -> f64 {
        let planes =
            self.around(vertex).map(|face| face.normal.dot(moved).abs()).fold(0.0, f64::max);
        let rim = self.rim(vertex).map_or(0.0, |rim| moved.dot(*rim * moved).max(0.0).sqrt());
        planes.max(rim)
    }

    /// The squares of the normals around some vertices, by area: how much moving along each direction matters.
    pub(super) fn normals(&self, vertices: std::ops::Range<usize>) -> DMat3 {
        let mut sum = DMat3::ZERO;
        for face in vertices.flat_map(|v| self.around(v)) {
            sum += outer(face.normal) * face.area;
        }
        sum
    }
}

impl Face {
    /// The corner after one of them.
    fn after(&self, corner: u32) -> u32 {
        let [a, b, c] = self.corners;
        if corner == a {
            b
        } else if corner == b {
            c
        } else {
            a
        }
    }

    /// Whether other corners turn it by more than a right angle, or leave it none of its area: then which way it is
    /// turned is for rounding to say.
    pub(super) fn is_flipped(&self, [a, b, c]: [DVec3; 3]) -> bool {
        (b - a).cross(c - a).dot(self.normal) <= NO_AREA * self.area
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

/// So much of a face's area is none.
const NO_AREA: f64 = 1e-9;

/// The squares of the directions across a border at each of its vertices.
fn rims(faces: &[Face], places: &[DVec3]) -> HashMap<u32, DMat3> {
    let triangles: Vec<_> = faces.iter().map(|face| face.corners.map(VertexId)).collect();
    let connectivity = Connectivity::new(&triangles, places.len());
    let mut rims = HashMap::new();
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
                *rims.entry(v).or_insert(DMat3::ZERO) += outer(across);
            }
        }
    }
    rims
}

/// The square of a vector, as a matrix.
pub(super) fn outer(v: DVec3) -> DMat3 {
    DMat3::from_cols(v * v.x, v * v.y, v * v.z)
}

/// The square of the distance to the nearest of some triangles, or to one that is near enough.
fn nearest(p: DVec3, triangles: impl Iterator<Item = [DVec3; 3]>, enough: f64) -> f64 {
    let mut nearest = f64::INFINITY;
    for corners in triangles {
        nearest = nearest.min(p.distance_squared(closest(p, corners)));
        if nearest <= enough {
            break;
        }
    }
    nearest
}

/// The point of a triangle closest to another.
fn closest(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let inside = |a: DVec3, b: DVec3| (b - a).cross(p - a).dot(normal) >= 0.0;
    if normal != DVec3::ZERO && inside(a, b) && inside(b, c) && inside(c, a) {
        return p - normal * ((p - a).dot(normal) / normal.length_squared());
    }
    let on = |a: DVec3, b: DVec3| {
        let along = b - a;
        let part = (p - a).dot(along) / along.length_squared();
        // Also of a side that is a point.
        a + along * if part > 0.0 { part.min(1.0) } else { 0.0 }
    };
    let nearer = |x: DVec3, y: DVec3| {
        if y.distance_squared(p) < x.distance_squared(p) { y } else { x }
    };
    nearer(nearer(on(a, b), on(b, c)), on(c, a))
}
