//! Rebuilds the mesh with its faces cut at intersection points and segments.

use glam::DVec3;
use meshlod_mesh::{FaceId, Mesh, VertexId, WedgeId};
use rustc_hash::{FxHashMap, FxHashSet};

use super::interpolate::interpolate_wedge;
use super::points::{EndPoint, FaceInterior, IntersectionPoints, PointId, rounding};
use super::triangulate::{FaceCuts, FaceTriangulation, triangulate};
use crate::check::edges::lowest_first;
use crate::unique_positions::UniquePositions;

/// A mesh being rebuilt face by face, with its faces cut at intersections.
pub struct CutMesh<'a> {
    mesh: &'a Mesh,
    unique: &'a UniquePositions,
    points: &'a IntersectionPoints,
    /// All vertices so far; faces and corners of the faces done so far.
    done: Mesh,
    /// Face of the original mesh that each face done so far is, or is a piece of.
    origins: Vec<u32>,
    /// Vertex of each point on an edge, and its wedge between two wedges: faces on both sides share
    /// them.
    vertices: FxHashMap<(PointId, [VertexId; 2]), VertexId>,
    wedges: FxHashMap<(PointId, [WedgeId; 2]), WedgeId>,
    contact_edges: FxHashSet<[VertexId; 2]>,
}

/// A corner or intersection point of a face that is cut.
#[derive(Clone, Copy)]
struct CutPoint {
    vertex: VertexId,
    position: DVec3,
    /// Barycentric coordinates in the face.
    weights: [f64; 3],
    /// The intersection point and the edge that it lies on, if any.
    on_edge: Option<(PointId, usize)>,
}

/// A face with the points and segments that cut it.
struct CutFace {
    triangle: [DVec3; 3],
    points: Vec<CutPoint>,
    /// Index of each intersection point in `points`.
    numbers: FxHashMap<PointId, usize>,
    cuts: FaceCuts,
}

/// Limit on the comparisons of points with segments in a face; it takes thousands of both.
const MOST_TESTS: usize = 1 << 26;

impl CutFace {
    fn of(mesh: &Mesh, face: FaceId) -> Self {
        let corners = mesh.faces[face.index()];
        let triangle = mesh.triangle(corners);
        let point = |k: usize| {
            let weights = [0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 });
            CutPoint { vertex: corners[k], position: triangle[k], weights, on_edge: None }
        };
        let points = [0, 1, 2].map(point).to_vec();
        let (numbers, cuts) = Default::default();
        Self { triangle, points, numbers, cuts }
    }

    fn add(&mut self, id: PointId, point: CutPoint) {
        self.numbers.insert(id, self.points.len());
        self.points.push(point);
    }

    /// Splits a segment at the points that lie on it up to rounding, since segments of several
    /// components may overlap.
    fn split_at_points(&self, [from, to]: [usize; 2]) -> Vec<[usize; 2]> {
        let rounding = rounding(&self.triangle);
        let start = self.points[from].position;
        let way = self.points[to].position - start;
        let along = |position: DVec3| (position - start).dot(way) / way.length_squared();
        let between = |&(_, t): &(usize, f64)| t > 0.0 && t < 1.0;
        let is_on = |&(i, t): &(usize, f64)| {
            (start + way * t).distance_squared(self.points[i].position) <= rounding * rounding
        };
        let points = self.points.iter().enumerate().map(|(i, point)| (i, along(point.position)));
        let mut on: Vec<_> =
            points.filter(|&(i, _)| i != from && i != to).filter(between).filter(is_on).collect();
        on.sort_by(|a, b| a.1.total_cmp(&b.1));
        let stops: Vec<usize> =
            [from].into_iter().chain(on.into_iter().map(|(i, _)| i)).chain([to]).collect();
        stops.windows(2).map(|ends| [ends[0], ends[1]]).collect()
    }

    /// Returns true if a point is bitwise at one of the given corners, whose number it then gets.
    fn merge_with_corner(&mut self, id: PointId, position: DVec3, corners: &[usize]) -> bool {
        let corner = corners.iter().copied().find(|&corner| self.triangle[corner] == position);
        corner.map(|corner| self.numbers.insert(id, corner)).is_some()
    }
}

impl<'a> CutMesh<'a> {
    pub fn new(
        mesh: &'a Mesh,
        unique: &'a UniquePositions,
        points: &'a IntersectionPoints,
    ) -> Self {
        let mut done = mesh.clone();
        done.faces.clear();
        if let Some(attributes) = &mut done.attributes {
            attributes.corners.clear();
        }
        let (origins, vertices, wedges, contact_edges) = Default::default();
        Self { mesh, unique, points, done, origins, vertices, wedges, contact_edges }
    }

    /// Adds a face of the original mesh uncut; returns 1, the number of faces added.
    pub fn keep(&mut self, face: FaceId) -> usize {
        let wedges = self.mesh.attributes.as_ref().map(|all| all.corners[face.index()]);
        self.push(face, self.mesh.faces[face.index()], wedges);
        1
    }

    /// Adds a face of the original mesh, or the pieces it is cut into; returns the number of faces
    /// added.
    pub fn add(&mut self, face: FaceId) -> usize {
        let corners = self.mesh.faces[face.index()];
        let wedges = self.mesh.attributes.as_ref().map(|all| all.corners[face.index()]);
        let along = [0, 1, 2]
            .map(|k| [k, (k + 1) % 3].map(|k| self.unique.representative(corners[k])))
            .map(|edge| self.points.along(edge));
        let inside = self.points.inside(face);
        if inside.is_none() && along.iter().all(Vec::is_empty) {
            self.push(face, corners, wedges);
            return 1;
        }
        let mut cut_face = CutFace::of(self.mesh, face);
        for (k, points) in along.iter().enumerate() {
            for &id in points {
                self.add_on_edge(&mut cut_face, k, id);
            }
        }
        if let Some(inside) = inside {
            inside.points.iter().for_each(|&id| self.add_inside(&mut cut_face, id));
            cut_face.cuts.segments = self.segments_between(corners, &cut_face, inside);
        }
        let CutFace { points, cuts, .. } = cut_face;
        let FaceTriangulation { triangles, segments } = triangulate(&cuts);
        let ends = |segment: [usize; 2]| lowest_first(segment.map(|point| points[point].vertex));
        self.contact_edges.extend(segments.into_iter().map(ends));
        let wedges = wedges.map(|corners| self.wedges(corners, &points));
        for triangle in &triangles {
            let wedges = wedges.as_ref().map(|wedges| triangle.map(|point| wedges[point]));
            self.push(face, triangle.map(|point| points[point].vertex), wedges);
        }
        triangles.len()
    }

    /// Returns the finished mesh and its edges along intersections, as vertex pairs with the lower
    /// id first.
    pub fn finish(mut self) -> (Mesh, FxHashSet<[VertexId; 2]>) {
        for labels in self.done.materials.iter_mut().chain(&mut self.done.objects) {
            *labels = labels.select(&self.origins);
        }
        self.done.face_layers = self.mesh.select_face_layers(&self.origins);
        (self.done, self.contact_edges)
    }

    /// Appends a piece of a face.
    fn push(&mut self, of: FaceId, corners: [VertexId; 3], wedges: Option<[WedgeId; 3]>) {
        self.done.faces.push(corners);
        if let (Some(attributes), Some(wedges)) = (&mut self.done.attributes, wedges) {
            attributes.corners.push(wedges);
        }
        self.origins.push(of.0);
    }

    fn add_on_edge(&mut self, cut_face: &mut CutFace, edge: usize, id: PointId) {
        let position = self.points.position(id);
        let ends = [edge, (edge + 1) % 3];
        // Not the third corner, which the face across the edge does not share.
        if cut_face.merge_with_corner(id, position, &ends) {
            return;
        }
        let [from, to] = ends.map(|k| cut_face.triangle[k]);
        let t = ((position - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
        let mut weights = [0.0; 3];
        (weights[ends[0]], weights[ends[1]]) = (1.0 - t, t);
        let key = (id, lowest_first(ends.map(|k| cut_face.points[k].vertex)));
        let positions = &mut self.done.positions;
        let vertex = *self.vertices.entry(key).or_insert_with(|| new_vertex(positions, position));
        cut_face.cuts.along[edge].push(t);
        cut_face.add(id, CutPoint { vertex, position, weights, on_edge: Some((id, edge)) });
    }

    fn add_inside(&mut self, cut_face: &mut CutFace, id: PointId) {
        let position = self.points.position(id);
        let known = cut_face.numbers.contains_key(&id);
        if known || cut_face.merge_with_corner(id, position, &[0, 1, 2]) {
            return;
        }
        let weights = barycentric(&cut_face.triangle, position);
        let vertex = new_vertex(&mut self.done.positions, position);
        cut_face.cuts.inside.push([weights[1], weights[2]]);
        cut_face.add(id, CutPoint { vertex, position, weights, on_edge: None });
    }

    /// Returns the intersection segments of a face as pairs of its points.
    fn segments_between(
        &self,
        corners: [VertexId; 3],
        cut_face: &CutFace,
        inside: &FaceInterior,
    ) -> Vec<[usize; 2]> {
        let point = |end: EndPoint| match end {
            EndPoint::Corner(vertex) => {
                corners.iter().position(|&v| self.unique.representative(v) == vertex)
            }
            EndPoint::Point(id) => cut_face.numbers.get(&id).copied(),
        };
        let segments = inside.segments.iter().map(|segment| segment.ends.map(point));
        let segments: Vec<_> = segments.filter_map(|[from, to]| Some([from?, to?])).collect();
        if segments.len() * cut_face.points.len() > MOST_TESTS {
            return segments;
        }
        segments.iter().flat_map(|&segment| cut_face.split_at_points(segment)).collect()
    }

    /// Returns the wedges of the points: those of the corners and new ones.
    fn wedges(&mut self, corners: [WedgeId; 3], points: &[CutPoint]) -> Vec<WedgeId> {
        let Some(attributes) = &mut self.done.attributes else { return Vec::new() };
        let known = &mut self.wedges;
        let new = points[3..].iter().map(|point| match point.on_edge {
            None => interpolate_wedge(attributes, corners, point.weights),
            Some((id, k)) => {
                let key = (id, lowest_first([corners[k], corners[(k + 1) % 3]]));
                *known
                    .entry(key)
                    .or_insert_with(|| interpolate_wedge(attributes, corners, point.weights))
            }
        });
        corners.into_iter().chain(new).collect()
    }
}

fn new_vertex(positions: &mut Vec<[f64; 3]>, position: DVec3) -> VertexId {
    positions.push(position.into());
    VertexId::new(positions.len() - 1)
}

/// Computes the barycentric coordinates of a point in a triangle.
fn barycentric(&[a, b, c]: &[DVec3; 3], point: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let weight = |from: DVec3, to: DVec3| {
        let area = (from - point).cross(to - point);
        (normal.dot(area) / normal.length_squared()).clamp(0.0, 1.0)
    };
    let [second, third] = [weight(c, a), weight(a, b)];
    [(1.0 - second - third).max(0.0), second, third]
}
