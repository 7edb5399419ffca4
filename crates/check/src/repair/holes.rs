//! Closing holes.

use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId, WedgeId, face_components};
use rustc_hash::FxHashSet;

use super::edit::{labels, retain_faces};
use super::meeting::meeting;
use super::patch::{Ring, patch, triangles_weighed};
use crate::check::boundary::{Boundary, Line};

/// Which holes are closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoleLimits {
    /// Those of at most this many edges; never more than [`HoleLimits::MOST_EDGES`].
    pub edges: usize,
    /// Those of at most this length around, in model units.
    pub length: f64,
}

impl HoleLimits {
    /// A filling is sought in time that grows with the cube of the edges: here 0.2 s at most.
    pub const MOST_EDGES: usize = 256;

    /// The triangles that are weighed for all fillings of a mesh together: those of 48 holes of 256
    /// edges, or of a thousand of 92. It takes 2 s, or 8 s where holes are flat and many fillings are
    /// as good.
    pub(super) const MOST_WEIGHED: usize = 1 << 27;
}

/// What came of it.
#[derive(Debug, Default, PartialEq)]
pub struct Filled {
    /// Holes closed.
    pub holes: usize,
    /// Faces that close them.
    pub faces: usize,
    /// Holes within the limits that no filling fits.
    pub left: usize,
    /// Holes within the limits for which none was sought.
    pub untried: usize,
}

/// Closes the holes within `limits`, each with the faces between its own vertices that bend least
/// ([`patch`]).
///
/// A hole is left where it is the outline of a sheet, so that its filling would be as large as all
/// that it is the border of; where its faces do not agree, where no filling keeps every edge to two faces and
/// every face to an area, or where the filling would meet other faces. Corners get the wedges that
/// the border has there, faces the labels of the border's first.
///
/// The largest holes are not tried where for all together more than `most_weighed` triangles would have
/// to be weighed.
pub fn fill(mesh: &mut Mesh, limits: &HoleLimits, most_weighed: usize) -> Filled {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let boundary = Boundary::of(&mesh.faces, &connectivity);
    let areas = ComponentAreas::of(mesh);
    let mut lines = boundary.lines_in_order();
    lines.retain(|&line| line.closed && is_within(mesh, boundary.vertices(line), limits));
    let tried = affordable(&lines, most_weighed);
    let mut filled = Filled { untried: lines.len() - tried.len(), ..Filled::default() };
    let mut drawn = FxHashSet::default();
    let before = mesh.faces.len();
    // The hole of every new face.
    let mut hole_of: Vec<usize> = Vec::new();
    for line in tried {
        let hole = Hole::of(mesh, &connectivity, boundary.vertices(line));
        match hole
            .and_then(|hole| hole.faces(mesh, &connectivity, &drawn).map(|faces| (hole, faces)))
            .filter(|(hole, faces)| hole.area(mesh, faces) < SHEET * areas.around(hole.face))
        {
            Some((hole, faces)) => {
                hole_of.extend(faces.iter().map(|_| filled.holes));
                filled.holes += 1;
                hole.add(mesh, &faces, &mut drawn);
            }
            None => filled.left += 1,
        }
    }
    let undone = drop_meeting(mesh, before, &hole_of);
    filled.holes -= undone;
    filled.left += undone;
    filled.faces = mesh.faces.len() - before;
    filled
}

/// The part of a component's area from which on a filling makes it a sheet with two sides. The lid
/// of a half sphere has half its area.
const SHEET: f64 = 0.9;

/// How large the components are.
struct ComponentAreas {
    of_face: Vec<u32>,
    areas: Vec<f64>,
}

impl ComponentAreas {
    fn of(mesh: &Mesh) -> Self {
        let (of_face, count) = face_components(&mesh.faces, mesh.positions.len());
        let mut areas = vec![0.0; count];
        for (face, &component) in mesh.faces.iter().zip(&of_face) {
            areas[component as usize] += area(mesh, *face);
        }
        Self { of_face, areas }
    }

    fn around(&self, face: FaceId) -> f64 {
        self.areas[self.of_face[face.index()] as usize]
    }
}

fn area(mesh: &Mesh, face: [VertexId; 3]) -> f64 {
    let [a, b, c] = mesh.triangle(face);
    0.5 * (b - a).cross(c - a).length()
}

fn is_within(mesh: &Mesh, vertices: &[VertexId], limits: &HoleLimits) -> bool {
    let at = |i: usize| glam::DVec3::from(mesh.positions[vertices[i % vertices.len()].index()]);
    let length = || (0..vertices.len()).map(|i| at(i).distance(at(i + 1))).sum::<f64>();
    vertices.len() <= limits.edges.min(HoleLimits::MOST_EDGES) && length() <= limits.length
}

/// The holes for which fillings can be sought with a budget of work: the smallest, of equal ones the
/// first, in their order.
fn affordable(holes: &[Line], most_weighed: usize) -> Vec<Line> {
    let mut smallest: Vec<usize> = (0..holes.len()).collect();
    smallest.sort_by_key(|&i| holes[i].len());
    let mut left = most_weighed;
    let fits = |&&i: &&usize| {
        let rest = left.checked_sub(triangles_weighed(holes[i].len()));
        left = rest.unwrap_or(0);
        rest.is_some()
    };
    let mut fitting: Vec<usize> = smallest.iter().take_while(fits).copied().collect();
    fitting.sort_unstable();
    fitting.into_iter().map(|i| holes[i]).collect()
}

/// Leaves the fillings out again that meet other faces, and says how many.
fn drop_meeting(mesh: &mut Mesh, before: usize, hole_of: &[usize]) -> usize {
    if hole_of.is_empty() {
        return 0;
    }
    let meeting: FxHashSet<usize> = match meeting(mesh, before) {
        Some(faces) => faces.into_iter().map(|face| hole_of[face.index() - before]).collect(),
        // Which of them meet is not known.
        None => hole_of.iter().copied().collect(),
    };
    retain_faces(mesh, |f| f < before || !meeting.contains(&hole_of[f - before]));
    meeting.len()
}

/// A hole, seen from the faces that will close it: in their order around it.
struct Hole {
    vertices: Vec<VertexId>,
    /// The wedge of the border at each.
    wedges: Option<Vec<WedgeId>>,
    /// The third corner of the face across the edge from each to the next.
    tips: Vec<VertexId>,
    /// A face at the border.
    face: FaceId,
}

impl Hole {
    /// The hole inside a loop of border vertices; `None` where the border's faces do not all run
    /// the same way along it.
    fn of(mesh: &Mesh, connectivity: &Connectivity, border: &[VertexId]) -> Option<Self> {
        let around: Vec<VertexId> = border.iter().rev().copied().collect();
        let sides: Option<Vec<Side>> = (0..around.len())
            .map(|i| leaving(mesh, connectivity, around[(i + 1) % around.len()], around[i]))
            .collect();
        let sides = sides?;
        let corner = |side: Side, k: usize| (side.face().index(), (side.corner() + k) % 3);
        let wedges = mesh.attributes.as_ref().map(|attributes| {
            // A side of the border runs against the hole: it ends in its vertex.
            let wedges = sides.iter().map(|&side| corner(side, 1));
            wedges.map(|(f, k)| attributes.corners[f][k]).collect()
        });
        let tips =
            sides.iter().map(|&side| corner(side, 2)).map(|(f, k)| mesh.faces[f][k]).collect();
        Some(Self { vertices: around, wedges, tips, face: sides[0].face() })
    }

    /// The area of faces between its vertices.
    fn area(&self, mesh: &Mesh, faces: &[[usize; 3]]) -> f64 {
        faces.iter().map(|face| area(mesh, face.map(|i| self.vertices[i]))).sum()
    }

    /// The faces that close it, as places around it; `None` where there are none that fit.
    fn faces(
        &self,
        mesh: &Mesh,
        connectivity: &Connectivity,
        drawn: &FxHashSet<[VertexId; 2]>,
    ) -> Option<Vec<[usize; 3]>> {
        let at = |v: &VertexId| mesh.positions[v.index()];
        let edges = self.edges_between(mesh, connectivity, drawn)?;
        let ring = Ring {
            points: self.vertices.iter().map(at).collect(),
            tips: self.tips.iter().map(at).collect(),
        };
        let faces = patch(&ring, |i, j| edges.contains(&[i.min(j), i.max(j)]))?;
        // Only a hole of three edges can be there as a face already.
        let whole = |face: &[VertexId; 3]| self.vertices.iter().all(|v| face.contains(v));
        let star = connectivity.star(self.vertices[0]).iter();
        let is_face = star.map(|face| &mesh.faces[face.index()]).any(whole);
        (self.vertices.len() > 3 || !is_face).then_some(faces)
    }

    /// The edges that run between vertices of the hole already, as places; `None` where a vertex has
    /// more faces than it is worth to search.
    fn edges_between(
        &self,
        mesh: &Mesh,
        connectivity: &Connectivity,
        drawn: &FxHashSet<[VertexId; 2]>,
    ) -> Option<FxHashSet<[usize; 2]>> {
        const MOST_AROUND: usize = 10_000;
        let mut place: Vec<(VertexId, usize)> = self.vertices.iter().copied().zip(0..).collect();
        place.sort_unstable();
        let mut edges = FxHashSet::default();
        for (i, &v) in self.vertices.iter().enumerate() {
            let star = connectivity.star(v);
            if star.len() > MOST_AROUND {
                return None;
            }
            let others = star.iter().flat_map(|face| mesh.faces[face.index()]);
            for other in others.filter(|&other| other != v) {
                if let Ok(found) = place.binary_search_by_key(&other, |&(v, _)| v) {
                    edges.insert([i.min(place[found].1), i.max(place[found].1)]);
                }
            }
            for (j, &w) in self.vertices.iter().enumerate().skip(i + 1) {
                if !drawn.is_empty() && drawn.contains(&[v.min(w), v.max(w)]) {
                    edges.insert([i, j]);
                }
            }
        }
        Some(edges)
    }

    fn add(&self, mesh: &mut Mesh, faces: &[[usize; 3]], drawn: &mut FxHashSet<[VertexId; 2]>) {
        for &places in faces {
            let face = places.map(|i| self.vertices[i]);
            mesh.faces.push(face);
            for k in 0..3 {
                let [a, b] = [face[k], face[(k + 1) % 3]];
                drawn.insert([a.min(b), a.max(b)]);
            }
            if let (Some(attributes), Some(wedges)) = (&mut mesh.attributes, &self.wedges) {
                attributes.corners.push(places.map(|i| wedges[i]));
            }
            for labels in labels(mesh) {
                labels.of_face.push(labels.of_face[self.face.index()]);
            }
        }
    }
}

/// The border side from one vertex to another.
fn leaving(mesh: &Mesh, connectivity: &Connectivity, from: VertexId, to: VertexId) -> Option<Side> {
    let sides =
        connectivity.star(from).iter().flat_map(|&face| [0, 1, 2].map(|k| Side::new(face, k)));
    sides
        .filter(|side| side.ends(&mesh.faces) == [from, to])
        .find(|&side| connectivity.twin(side) == Twin::Boundary)
}
