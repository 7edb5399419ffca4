//! The mesh with its faces in pieces.

use glam::DVec3;
use meshlod_mesh::{FaceId, Mesh, VertexId, WedgeId};
use rustc_hash::{FxHashMap, FxHashSet};

use super::blend::blend;
use super::cut::{Cut, Cuts, cut};
use super::spots::{Inside, Mark, SpotId, Spots, rounding};
use crate::check::edges::lowest_first;
use crate::places::Places;
use crate::repair::labels;

/// Pieces as they come, face after face.
pub struct Pieces<'a> {
    mesh: &'a Mesh,
    places: &'a Places,
    spots: &'a Spots,
    /// All vertices so far; faces, their corners and labels are those that are done.
    done: Mesh,
    /// The vertex of a spot on an edge, and its wedge between two: faces on both sides share them.
    vertices: FxHashMap<(SpotId, [VertexId; 2]), VertexId>,
    wedges: FxHashMap<(SpotId, [WedgeId; 2]), WedgeId>,
    lines: FxHashSet<[VertexId; 2]>,
}

/// A point of a face that is cut.
#[derive(Clone, Copy)]
struct Point {
    vertex: VertexId,
    place: DVec3,
    /// What it has of each corner.
    parts: [f64; 3],
    /// The spot that it is, and the edge that this is on.
    on_edge: Option<(SpotId, usize)>,
}

/// A face with what it is cut by.
struct Sketch {
    triangle: [DVec3; 3],
    points: Vec<Point>,
    /// The point that each spot is.
    numbers: FxHashMap<SpotId, usize>,
    cuts: Cuts,
}

/// How many points are compared with lines in a face. It takes thousands of both to get there.
const MOST_LOOKS: usize = 1 << 26;

impl Sketch {
    fn of(mesh: &Mesh, face: FaceId) -> Self {
        let corners = mesh.faces[face.index()];
        let triangle = mesh.triangle(corners);
        let point = |k: usize| {
            let parts = [0, 1, 2].map(|i| if i == k { 1.0 } else { 0.0 });
            Point { vertex: corners[k], place: triangle[k], parts, on_edge: None }
        };
        let points = [0, 1, 2].map(point).to_vec();
        let (numbers, cuts) = Default::default();
        Self { triangle, points, numbers, cuts }
    }

    fn add(&mut self, spot: SpotId, point: Point) {
        self.numbers.insert(spot, self.points.len());
        self.points.push(point);
    }

    /// A line in pieces, between the points that are on it but for rounding: lines of several
    /// components may run along each other.
    fn pieces_of(&self, [from, to]: [usize; 2]) -> Vec<[usize; 2]> {
        let rounding = rounding(&self.triangle);
        let start = self.points[from].place;
        let way = self.points[to].place - start;
        let along = |place: DVec3| (place - start).dot(way) / way.length_squared();
        let between = |&(_, t): &(usize, f64)| t > 0.0 && t < 1.0;
        let is_on = |&(i, t): &(usize, f64)| {
            (start + way * t).distance_squared(self.points[i].place) <= rounding * rounding
        };
        let points = self.points.iter().enumerate().map(|(i, point)| (i, along(point.place)));
        let mut on: Vec<_> =
            points.filter(|&(i, _)| i != from && i != to).filter(between).filter(is_on).collect();
        on.sort_by(|a, b| a.1.total_cmp(&b.1));
        let stops: Vec<usize> =
            [from].into_iter().chain(on.into_iter().map(|(i, _)| i)).chain([to]).collect();
        stops.windows(2).map(|ends| [ends[0], ends[1]]).collect()
    }

    /// Whether a spot is one of these corners, to the bit; then it is no point of its own.
    fn is_corner(&mut self, spot: SpotId, place: DVec3, of: &[usize]) -> bool {
        let corner = of.iter().copied().find(|&corner| self.triangle[corner] == place);
        corner.map(|corner| self.numbers.insert(spot, corner)).is_some()
    }
}

impl<'a> Pieces<'a> {
    pub fn new(mesh: &'a Mesh, places: &'a Places, spots: &'a Spots) -> Self {
        let mut done = mesh.clone();
        done.faces.clear();
        labels(&mut done).for_each(|labels| labels.of_face.clear());
        if let Some(attributes) = &mut done.attributes {
            attributes.corners.clear();
        }
        let (vertices, wedges, lines) = Default::default();
        Self { mesh, places, spots, done, vertices, wedges, lines }
    }

    /// Adds a face, or its pieces; says how many.
    pub fn add(&mut self, face: FaceId) -> usize {
        let corners = self.mesh.faces[face.index()];
        let wedges = self.mesh.attributes.as_ref().map(|all| all.corners[face.index()]);
        let along = [0, 1, 2]
            .map(|k| self.spots.along([k, (k + 1) % 3].map(|k| self.places.first(corners[k]))));
        let inside = self.spots.inside(face);
        if inside.is_none() && along.iter().all(Vec::is_empty) {
            self.push(face, corners, wedges);
            return 1;
        }
        let mut sketch = Sketch::of(self.mesh, face);
        for (k, spots) in along.iter().enumerate() {
            for &spot in spots {
                self.add_on_edge(&mut sketch, k, spot);
            }
        }
        if let Some(inside) = inside {
            inside.spots.iter().for_each(|&spot| self.add_inside(&mut sketch, spot));
            sketch.cuts.lines = self.lines_between(corners, &sketch, inside);
        }
        let Sketch { points, cuts, .. } = sketch;
        let Cut { triangles, lines } = cut(&cuts);
        let ends = |line: [usize; 2]| lowest_first(line.map(|point| points[point].vertex));
        self.lines.extend(lines.into_iter().map(ends));
        let wedges = wedges.map(|corners| self.wedges(corners, &points));
        for triangle in &triangles {
            let wedges = wedges.as_ref().map(|wedges| triangle.map(|point| wedges[point]));
            self.push(face, triangle.map(|point| points[point].vertex), wedges);
        }
        triangles.len()
    }

    /// The mesh, and its edges along lines, the lower vertex first.
    pub fn finish(self) -> (Mesh, FxHashSet<[VertexId; 2]>) {
        (self.done, self.lines)
    }

    /// Adds a piece of a face.
    fn push(&mut self, of: FaceId, corners: [VertexId; 3], wedges: Option<[WedgeId; 3]>) {
        self.done.faces.push(corners);
        if let (Some(attributes), Some(wedges)) = (&mut self.done.attributes, wedges) {
            attributes.corners.push(wedges);
        }
        let all = self.mesh.materials.iter().chain(&self.mesh.objects);
        for (labels, all) in labels(&mut self.done).zip(all) {
            labels.of_face.push(all.of(of.index()));
        }
    }

    fn add_on_edge(&mut self, sketch: &mut Sketch, edge: usize, spot: SpotId) {
        let place = self.spots.place(spot);
        let ends = [edge, (edge + 1) % 3];
        // Not the third: the face beyond the edge has another.
        if sketch.is_corner(spot, place, &ends) {
            return;
        }
        let [from, to] = ends.map(|k| sketch.triangle[k]);
        let t = ((place - from).dot(to - from) / (to - from).length_squared()).clamp(0.0, 1.0);
        let mut parts = [0.0; 3];
        (parts[ends[0]], parts[ends[1]]) = (1.0 - t, t);
        let key = (spot, lowest_first(ends.map(|k| sketch.points[k].vertex)));
        let positions = &mut self.done.positions;
        let vertex = *self.vertices.entry(key).or_insert_with(|| new_vertex(positions, place));
        sketch.cuts.along[edge].push(t);
        sketch.add(spot, Point { vertex, place, parts, on_edge: Some((spot, edge)) });
    }

    fn add_inside(&mut self, sketch: &mut Sketch, spot: SpotId) {
        let place = self.spots.place(spot);
        if sketch.numbers.contains_key(&spot) || sketch.is_corner(spot, place, &[0, 1, 2]) {
            return;
        }
        let parts = parts(&sketch.triangle, place);
        let vertex = new_vertex(&mut self.done.positions, place);
        sketch.cuts.inside.push([parts[1], parts[2]]);
        sketch.add(spot, Point { vertex, place, parts, on_edge: None });
    }

    /// The lines of a face, between its points.
    fn lines_between(
        &self,
        corners: [VertexId; 3],
        sketch: &Sketch,
        inside: &Inside,
    ) -> Vec<[usize; 2]> {
        let point = |mark: Mark| match mark {
            Mark::Corner(place) => corners.iter().position(|&v| self.places.first(v) == place),
            Mark::Spot(spot) => sketch.numbers.get(&spot).copied(),
        };
        let lines = inside.lines.iter().map(|line| line.ends.map(point));
        let lines: Vec<_> = lines.filter_map(|[from, to]| Some([from?, to?])).collect();
        if lines.len() * sketch.points.len() > MOST_LOOKS {
            return lines;
        }
        lines.iter().flat_map(|&line| sketch.pieces_of(line)).collect()
    }

    /// The wedges of points, new ones but for the corners.
    fn wedges(&mut self, corners: [WedgeId; 3], points: &[Point]) -> Vec<WedgeId> {
        let Some(attributes) = &mut self.done.attributes else { return Vec::new() };
        let known = &mut self.wedges;
        let new = points[3..].iter().map(|point| match point.on_edge {
            None => blend(attributes, corners, point.parts),
            Some((spot, k)) => {
                let key = (spot, lowest_first([corners[k], corners[(k + 1) % 3]]));
                *known.entry(key).or_insert_with(|| blend(attributes, corners, point.parts))
            }
        });
        corners.into_iter().chain(new).collect()
    }
}

fn new_vertex(positions: &mut Vec<[f64; 3]>, place: DVec3) -> VertexId {
    positions.push(place.into());
    VertexId::new(positions.len() - 1)
}

/// What a place in a triangle has of each corner.
fn parts(&[a, b, c]: &[DVec3; 3], place: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let part = |from: DVec3, to: DVec3| {
        let area = (from - place).cross(to - place);
        (normal.dot(area) / normal.length_squared()).clamp(0.0, 1.0)
    };
    let [second, third] = [part(c, a), part(a, b)];
    [(1.0 - second - third).max(0.0), second, third]
}
