//! The lines along which components meet, and the spots at their ends.

use glam::DVec3;
use meshlod_mesh::{FaceId, Mesh, VertexId, first_near};
use rustc_hash::FxHashMap;

use super::crossings::cross_lines;
use crate::check::edges::lowest_first;
use crate::check::subject::Subject;
use crate::intersect::{End, On};

/// A place at which some component gets a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SpotId(u32);

/// All spots and lines. Vertices stand for their places.
#[derive(Default)]
pub struct Spots {
    /// How many pairs of faces meet.
    pub pairs: usize,
    places: Vec<DVec3>,
    /// How far rounding may have moved each.
    rounding: Vec<f64>,
    /// In the order from the lower vertex to the other.
    of_edge: FxHashMap<[VertexId; 2], Vec<SpotId>>,
    in_face: FxHashMap<FaceId, Inside>,
}

/// What there is inside a face.
#[derive(Debug, Default)]
pub struct Inside {
    pub spots: Vec<SpotId>,
    pub lines: Vec<Line>,
}

/// Where a face meets another.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    pub ends: [Mark; 2],
    pub other: FaceId,
}

/// An end of a line in a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A vertex of the face.
    Corner(VertexId),
    Spot(SpotId),
}

/// The least part of a mesh that a spot is on.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Part {
    Vertex(VertexId),
    Edge([VertexId; 2]),
    Face(FaceId),
}

/// Places nearer than this part of coordinates are one: what the rounding of a few operations makes
/// of them.
const ROUNDING: f64 = 4e-14;

/// The spots known by the two parts that meet there.
type Known = FxHashMap<[Part; 2], SpotId>;

impl Spots {
    /// Where faces of different objects meet.
    pub fn of(subject: &Subject) -> Self {
        let mut spots = Self::default();
        let mut known = Known::default();
        let objects = &subject.objects().of_face;
        for &faces in subject.meetings().pairs() {
            if objects[faces[0].index()] != objects[faces[1].index()] {
                spots.pairs += usize::from(spots.add_pair(subject, faces, &mut known));
            }
        }
        cross_lines(&mut spots, subject.mesh);
        spots.unite(subject.mesh);
        spots.sort_edges(subject.mesh);
        spots
    }

    pub fn place(&self, spot: SpotId) -> DVec3 {
        self.places[spot.0 as usize]
    }

    /// What is inside a face.
    pub fn inside(&self, face: FaceId) -> Option<&Inside> {
        self.in_face.get(&face)
    }

    /// The spots along an edge, from its first to its second vertex.
    pub fn along(&self, edge: [VertexId; 2]) -> Vec<SpotId> {
        let Some(spots) = self.of_edge.get(&lowest_first(edge)) else { return Vec::new() };
        match edge[0] < edge[1] {
            true => spots.clone(),
            false => spots.iter().rev().copied().collect(),
        }
    }

    /// The faces with lines in them, lowest id first.
    pub(super) fn faces(&self) -> Vec<FaceId> {
        let mut faces: Vec<FaceId> = self.in_face.keys().copied().collect();
        faces.sort_unstable();
        faces
    }

    pub(super) fn inside_mut(&mut self, face: FaceId) -> &mut Inside {
        self.in_face.entry(face).or_default()
    }

    pub(super) fn add(&mut self, place: DVec3, rounding: f64) -> SpotId {
        self.places.push(place);
        self.rounding.push(rounding);
        SpotId(self.places.len() as u32 - 1)
    }

    /// Adds the line along which two faces meet; whether there is one, or a point of it.
    fn add_pair(&mut self, subject: &Subject, faces: [FaceId; 2], known: &mut Known) -> bool {
        let places = subject.places();
        let corners = faces.map(|face| subject.mesh.faces[face.index()].map(|v| places.first(v)));
        let Some(ends) = subject.meetings().ends(subject.mesh, corners) else { return false };
        let triangles = faces.map(|face| subject.mesh.triangle(subject.mesh.faces[face.index()]));
        let rounding = rounding(triangles.as_flattened());
        let marks = ends.map(|End { on, place }| {
            let parts = [0, 1].map(|i| Part::of(on[i], faces[i], &corners[i]));
            self.mark(parts, (place, rounding), known)
        });
        for i in [0, 1] {
            let ends = marks.map(|mark| mark[i]);
            if ends[0] != ends[1] {
                self.inside_mut(faces[i]).lines.push(Line { ends, other: faces[1 - i] });
            }
        }
        true
    }

    /// The spot on two parts, as each of their meshes has it.
    fn mark(
        &mut self,
        parts: [Part; 2],
        (place, rounding): (DVec3, f64),
        known: &mut Known,
    ) -> [Mark; 2] {
        if let [Part::Vertex(a), Part::Vertex(b)] = parts {
            return [a, b].map(Mark::Corner);
        }
        let mut key = parts;
        key.sort_unstable();
        let spot = *known.entry(key).or_insert_with(|| {
            let spot = self.add(place, rounding);
            for part in parts {
                match part {
                    Part::Vertex(_) => {}
                    Part::Edge(edge) => self.of_edge.entry(edge).or_default().push(spot),
                    Part::Face(face) => self.inside_mut(face).spots.push(spot),
                }
            }
            spot
        });
        parts.map(|part| match part {
            Part::Vertex(v) => Mark::Corner(v),
            _ => Mark::Spot(spot),
        })
    }

    /// Makes one of spots that are at one place but for rounding, and puts those at a vertex there:
    /// where three components meet, a place is found in more than one way.
    fn unite(&mut self, mesh: &Mesh) {
        let count = mesh.positions.len();
        let mut all = mesh.positions.clone();
        all.extend(self.places.iter().map(|place| place.to_array()));
        let near = first_near(&all, self.rounding.iter().copied().fold(0.0, f64::max));
        let mut firsts = FxHashMap::default();
        let united: Vec<SpotId> = (0..self.places.len())
            .map(|spot| {
                let first = near[count + spot];
                let place = DVec3::from(all[first as usize]);
                // What is large rounds farther than what is small.
                let is_near = place.distance(self.places[spot]) <= self.rounding[spot];
                let first = if is_near { first } else { (count + spot) as u32 };
                self.places[spot] = all[first as usize].into();
                *firsts.entry(first).or_insert(SpotId(spot as u32))
            })
            .collect();
        let unite = |spot: &mut SpotId| *spot = united[spot.0 as usize];
        self.of_edge.values_mut().flatten().for_each(unite);
        for inside in self.in_face.values_mut() {
            inside.spots.iter_mut().for_each(unite);
            inside.spots.sort_unstable();
            inside.spots.dedup();
            for mark in inside.lines.iter_mut().flat_map(|line| &mut line.ends) {
                if let Mark::Spot(spot) = mark {
                    unite(spot);
                }
            }
        }
    }

    fn sort_edges(&mut self, mesh: &Mesh) {
        for (edge, spots) in &mut self.of_edge {
            let [from, to] = edge.map(|v| DVec3::from(mesh.positions[v.index()]));
            let along = |spot: &SpotId| (to - from).dot(self.places[spot.0 as usize] - from);
            spots.sort_by(|a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
            spots.dedup();
        }
    }
}

impl Part {
    fn of(on: On, face: FaceId, corners: &[VertexId; 3]) -> Self {
        match on {
            On::Corner(i) => Self::Vertex(corners[i]),
            On::Edge(i) => Self::Edge(lowest_first([corners[i], corners[(i + 1) % 3]])),
            On::Inside => Self::Face(face),
        }
    }
}

/// How far rounding may move what is computed from these.
pub fn rounding(places: &[DVec3]) -> f64 {
    ROUNDING * places.iter().map(|place| place.abs().max_element()).fold(0.0, f64::max)
}
