//! Points and segments in which faces of different components intersect.

use glam::DVec3;
use meshlod_mesh::{FaceId, Mesh, VertexId, first_near};
use rustc_hash::FxHashMap;

use super::crossings::split_at_crossings;
use crate::check::edges::lowest_first;
use crate::check::subject::Subject;
use crate::intersect::{Feature, SegmentEnd};

/// Index of an intersection point among all points of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PointId(u32);

/// Intersection points and segments of all components of a mesh; vertices at one position are
/// represented by the lowest-numbered one.
#[derive(Default)]
pub struct IntersectionPoints {
    /// Number of pairs of intersecting faces of different components.
    pub pairs: usize,
    positions: Vec<DVec3>,
    /// Bound on the rounding error of each position.
    rounding: Vec<f64>,
    /// Points on each edge, ordered from its lower to its higher vertex.
    of_edge: FxHashMap<[VertexId; 2], Vec<PointId>>,
    in_face: FxHashMap<FaceId, FaceInterior>,
}

/// Intersection points and segments in the interior of a face.
#[derive(Debug, Default)]
pub struct FaceInterior {
    pub points: Vec<PointId>,
    pub segments: Vec<IntersectionSegment>,
}

/// Line segment in which a face intersects a face of another component.
#[derive(Clone, Copy, Debug)]
pub struct IntersectionSegment {
    pub ends: [EndPoint; 2],
    pub other: FaceId,
}

/// An end of an intersection segment in a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndPoint {
    /// A vertex of the face.
    Corner(VertexId),
    Point(PointId),
}

/// Feature of a mesh that contains a point: the vertex, edge or face of least dimension.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum MeshFeature {
    Vertex(VertexId),
    Edge([VertexId; 2]),
    Face(FaceId),
}

/// Distance, relative to the coordinates, within which points are the same: the rounding error of a
/// few operations.
const ROUNDING: f64 = 4e-14;

/// Known points, by the two features that intersect there.
type Known = FxHashMap<[MeshFeature; 2], PointId>;

impl IntersectionPoints {
    /// Finds the points and segments in which faces of different objects intersect, among the
    /// faces that `takes_part` chooses.
    pub fn of(subject: &Subject, takes_part: impl Fn(FaceId) -> bool) -> Self {
        let mut points = Self::default();
        let mut known = Known::default();
        let objects = &subject.objects().of_face;
        for &faces in subject.intersecting_pairs().pairs() {
            let differ = objects[faces[0].index()] != objects[faces[1].index()];
            if differ && faces.into_iter().all(&takes_part) {
                points.pairs += usize::from(points.add_pair(subject, faces, &mut known));
            }
        }
        split_at_crossings(&mut points, subject.mesh);
        points.merge_near(subject.mesh);
        points.sort_edges(subject.mesh);
        points
    }

    pub fn position(&self, point: PointId) -> DVec3 {
        self.positions[point.0 as usize]
    }

    /// Returns the intersection points and segments in the interior of a face; `None` if there are
    /// no such points.
    pub fn inside(&self, face: FaceId) -> Option<&FaceInterior> {
        self.in_face.get(&face)
    }

    /// Returns the intersection points on an edge, in order from its first vertex to its second.
    pub fn along(&self, edge: [VertexId; 2]) -> Vec<PointId> {
        let Some(points) = self.of_edge.get(&lowest_first(edge)) else { return Vec::new() };
        match edge[0] < edge[1] {
            true => points.clone(),
            false => points.iter().rev().copied().collect(),
        }
    }

    /// Returns the faces with intersection points or segments in their interior, lowest id first.
    pub(super) fn faces(&self) -> Vec<FaceId> {
        let mut faces: Vec<FaceId> = self.in_face.keys().copied().collect();
        faces.sort_unstable();
        faces
    }

    pub(super) fn inside_mut(&mut self, face: FaceId) -> &mut FaceInterior {
        self.in_face.entry(face).or_default()
    }

    pub(super) fn add(&mut self, position: DVec3, rounding: f64) -> PointId {
        self.positions.push(position);
        self.rounding.push(rounding);
        PointId(self.positions.len() as u32 - 1)
    }

    /// Adds the intersection of two faces; returns false if they do not intersect.
    fn add_pair(&mut self, subject: &Subject, faces: [FaceId; 2], known: &mut Known) -> bool {
        let unique = subject.unique_positions();
        let corners =
            faces.map(|face| subject.mesh.faces[face.index()].map(|v| unique.representative(v)));
        let Some(ends) = subject.intersecting_pairs().segment_ends(subject.mesh, corners) else {
            return false;
        };
        let triangles = faces.map(|face| subject.mesh.triangle(subject.mesh.faces[face.index()]));
        let rounding = rounding(triangles.as_flattened());
        let ends = ends.map(|SegmentEnd { on, position }| {
            let features = [0, 1].map(|i| MeshFeature::of(on[i], faces[i], &corners[i]));
            self.end_points(features, (position, rounding), known)
        });
        for i in [0, 1] {
            let ends = ends.map(|end| end[i]);
            if ends[0] != ends[1] {
                let segment = IntersectionSegment { ends, other: faces[1 - i] };
                self.inside_mut(faces[i]).segments.push(segment);
            }
        }
        true
    }

    /// Returns the point where two features intersect, as an end point in each of their faces.
    fn end_points(
        &mut self,
        features: [MeshFeature; 2],
        (position, rounding): (DVec3, f64),
        known: &mut Known,
    ) -> [EndPoint; 2] {
        if let [MeshFeature::Vertex(a), MeshFeature::Vertex(b)] = features {
            return [a, b].map(EndPoint::Corner);
        }
        let mut key = features;
        key.sort_unstable();
        let point = *known.entry(key).or_insert_with(|| {
            let point = self.add(position, rounding);
            for feature in features {
                match feature {
                    MeshFeature::Vertex(_) => {}
                    MeshFeature::Edge(edge) => self.of_edge.entry(edge).or_default().push(point),
                    MeshFeature::Face(face) => self.inside_mut(face).points.push(point),
                }
            }
            point
        });
        features.map(|feature| match feature {
            MeshFeature::Vertex(v) => EndPoint::Corner(v),
            _ => EndPoint::Point(point),
        })
    }

    /// Merges points that coincide up to rounding, and snaps those at a vertex to it.
    ///
    /// Where three components meet, a point is found in more than one way.
    fn merge_near(&mut self, mesh: &Mesh) {
        let count = mesh.positions.len();
        let mut all = mesh.positions.clone();
        all.extend(self.positions.iter().map(|position| position.to_array()));
        let near = first_near(&all, self.rounding.iter().copied().fold(0.0, f64::max));
        let mut firsts = FxHashMap::default();
        let merged: Vec<PointId> = (0..self.positions.len())
            .map(|point| {
                let first = near[count + point];
                let position = DVec3::from(all[first as usize]);
                // The search used the largest rounding error; this point's own may be smaller.
                let is_near = position.distance(self.positions[point]) <= self.rounding[point];
                let first = if is_near { first } else { (count + point) as u32 };
                self.positions[point] = all[first as usize].into();
                *firsts.entry(first).or_insert(PointId(point as u32))
            })
            .collect();
        let merge = |point: &mut PointId| *point = merged[point.0 as usize];
        self.of_edge.values_mut().flatten().for_each(merge);
        for inside in self.in_face.values_mut() {
            inside.points.iter_mut().for_each(merge);
            inside.points.sort_unstable();
            inside.points.dedup();
            for end in inside.segments.iter_mut().flat_map(|segment| &mut segment.ends) {
                if let EndPoint::Point(point) = end {
                    merge(point);
                }
            }
        }
    }

    fn sort_edges(&mut self, mesh: &Mesh) {
        for (edge, points) in &mut self.of_edge {
            let [from, to] = edge.map(|v| DVec3::from(mesh.positions[v.index()]));
            let along = |point: &PointId| (to - from).dot(self.positions[point.0 as usize] - from);
            points.sort_by(|a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
            points.dedup();
        }
    }
}

impl MeshFeature {
    fn of(on: Feature, face: FaceId, corners: &[VertexId; 3]) -> Self {
        match on {
            Feature::Corner(i) => Self::Vertex(corners[i]),
            Feature::Edge(i) => Self::Edge(lowest_first([corners[i], corners[(i + 1) % 3]])),
            Feature::Inside => Self::Face(face),
        }
    }
}

/// Returns a bound on the rounding error of points computed from the given positions.
pub fn rounding(positions: &[DVec3]) -> f64 {
    ROUNDING * positions.iter().map(|position| position.abs().max_element()).fold(0.0, f64::max)
}
