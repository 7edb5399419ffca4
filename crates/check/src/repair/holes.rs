//! Fills holes of a mesh with new triangles.

use meshlod_mesh::{Connectivity, FaceId, Mesh, Side, Twin, VertexId, WedgeId, face_components};
use rustc_hash::FxHashSet;

use super::edit::{repeat_face_values, retain_faces};
use super::intersecting::intersecting;
use super::triangulate::{HoleOutline, triangles_weighed, triangulate};
use crate::check::boundary::{Boundary, BoundaryPolyline};

/// Limits on the size of the holes that are filled.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct HoleLimits {
    /// Maximum number of edges of a hole, never more than [`HoleLimits::MOST_EDGES`].
    pub edges: usize,
    /// Maximum perimeter of a hole, in model units; `None` for any.
    pub length: Option<f64>,
}

impl Default for HoleLimits {
    /// Returns the limits of all holes that can be filled.
    fn default() -> Self {
        Self { edges: Self::MOST_EDGES, length: None }
    }
}

impl HoleLimits {
    /// Largest number of edges of a hole that can be filled, whatever the limits. Time grows with
    /// its cube, to 0.2 s at this size.
    pub const MOST_EDGES: usize = 256;

    /// Budget of triangles weighed for all holes of a mesh: enough for 48 holes of 256 edges or a
    /// thousand of 92. It takes 2 s, or 8 s if holes are flat and many triangulations are equally
    /// good.
    pub(super) const MOST_WEIGHED: usize = 1 << 27;
}

/// Counts of the holes filled and left open.
#[derive(Debug, Default, PartialEq)]
pub struct Filled {
    /// Number of holes filled.
    pub holes: usize,
    /// Number of faces added to fill holes.
    pub faces: usize,
    /// Number of holes within the size limits for which no triangulation is valid.
    pub left: usize,
    /// Number of holes within the size limits left open because the work allowed for the mesh was
    /// used up.
    pub untried: usize,
}

/// Fills the holes within `limits`, each with the triangles between its own vertices that bend
/// least ([`triangulate`]).
///
/// A hole is left open if it is the outline of a sheet, so that its filling would be about as large
/// as the component it bounds; if its faces are not consistently oriented; if no triangulation
/// keeps all edges manifold and all faces nondegenerate; or if the filling would intersect other
/// faces. Corners get the wedges of the boundary, and faces the labels of the first boundary face.
///
/// The largest holes are not tried if all together would exceed the budget of `most_weighed`
/// triangles.
pub fn fill(mesh: &mut Mesh, limits: &HoleLimits, most_weighed: usize) -> Filled {
    let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
    let boundary = Boundary::of(&mesh.faces, &connectivity);
    let areas = ComponentAreas::of(mesh);
    let mut holes = boundary.sorted_polylines();
    holes.retain(|&hole| hole.closed && is_within(mesh, boundary.vertices(hole), limits));
    let tried = affordable(&holes, most_weighed);
    let mut filled = Filled { untried: holes.len() - tried.len(), ..Filled::default() };
    let mut new_edges = FxHashSet::default();
    let before = mesh.faces.len();
    // Hole of each new face.
    let mut hole_of: Vec<usize> = Vec::new();
    for polyline in tried {
        let hole = Hole::of(mesh, &connectivity, boundary.vertices(polyline));
        match hole
            .and_then(|hole| hole.faces(mesh, &connectivity, &new_edges).map(|faces| (hole, faces)))
            .filter(|(hole, faces)| hole.area(mesh, faces) < SHEET * areas.around(hole.face))
        {
            Some((hole, faces)) => {
                hole_of.extend(faces.iter().map(|_| filled.holes));
                filled.holes += 1;
                hole.add(mesh, &faces, &mut new_edges);
            }
            None => filled.left += 1,
        }
    }
    let undone = drop_intersecting(mesh, before, &hole_of);
    filled.holes -= undone;
    filled.left += undone;
    filled.faces = mesh.faces.len() - before;
    filled
}

/// Fraction of a component's area from which a filling would duplicate it as a two-sided sheet. The
/// lid of a hemisphere has half its area.
const SHEET: f64 = 0.9;

/// Areas of the components.
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
    vertices.len() <= limits.edges.min(HoleLimits::MOST_EDGES)
        && limits.length.is_none_or(|most| length() <= most)
}

/// Returns the holes that fit the budget, smallest first and the first among equals, in their
/// original order.
fn affordable(holes: &[BoundaryPolyline], most_weighed: usize) -> Vec<BoundaryPolyline> {
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

/// Removes the fillings that intersect other faces; returns the number of holes left open.
fn drop_intersecting(mesh: &mut Mesh, before: usize, hole_of: &[usize]) -> usize {
    if hole_of.is_empty() {
        return 0;
    }
    let dropped: FxHashSet<usize> = match intersecting(mesh, before) {
        Some(faces) => faces.into_iter().map(|face| hole_of[face.index() - before]).collect(),
        // The search gave up, so any of them may intersect.
        None => hole_of.iter().copied().collect(),
    };
    retain_faces(mesh, |f| f < before || !dropped.contains(&hole_of[f - before]));
    dropped.len()
}

/// A hole, traversed in the direction of the faces that will fill it.
struct Hole {
    vertices: Vec<VertexId>,
    /// Wedge of the boundary at each vertex.
    wedges: Option<Vec<WedgeId>>,
    /// Third corner of the face across the edge from each vertex to the next.
    tips: Vec<VertexId>,
    /// A face at the boundary.
    face: FaceId,
}

impl Hole {
    /// Returns the hole inside a boundary loop; `None` if the faces along it are not consistently
    /// oriented.
    fn of(mesh: &Mesh, connectivity: &Connectivity, boundary: &[VertexId]) -> Option<Self> {
        let around: Vec<VertexId> = boundary.iter().rev().copied().collect();
        let sides: Option<Vec<Side>> = (0..around.len())
            .map(|i| boundary_side(mesh, connectivity, around[(i + 1) % around.len()], around[i]))
            .collect();
        let sides = sides?;
        let corner = |side: Side, k: usize| (side.face().index(), (side.corner() + k) % 3);
        let wedges = mesh.attributes.as_ref().map(|attributes| {
            // A boundary side runs against the hole: it ends at the hole's vertex.
            let wedges = sides.iter().map(|&side| corner(side, 1));
            wedges.map(|(f, k)| attributes.corners[f][k]).collect()
        });
        let tips =
            sides.iter().map(|&side| corner(side, 2)).map(|(f, k)| mesh.faces[f][k]).collect();
        Some(Self { vertices: around, wedges, tips, face: sides[0].face() })
    }

    /// Returns the area of faces between the vertices of the hole.
    fn area(&self, mesh: &Mesh, faces: &[[usize; 3]]) -> f64 {
        faces.iter().map(|face| area(mesh, face.map(|i| self.vertices[i]))).sum()
    }

    /// Returns the faces that fill the hole, as indices around it; `None` if none are valid.
    fn faces(
        &self,
        mesh: &Mesh,
        connectivity: &Connectivity,
        new_edges: &FxHashSet<[VertexId; 2]>,
    ) -> Option<Vec<[usize; 3]>> {
        let at = |v: &VertexId| mesh.positions[v.index()];
        let edges = self.edges_between(mesh, connectivity, new_edges)?;
        let outline = HoleOutline {
            points: self.vertices.iter().map(at).collect(),
            tips: self.tips.iter().map(at).collect(),
        };
        let faces = triangulate(&outline, |i, j| edges.contains(&[i.min(j), i.max(j)]))?;
        // Only a hole of three edges can exist as a face already.
        let whole = |face: &[VertexId; 3]| self.vertices.iter().all(|v| face.contains(v));
        let star = connectivity.star(self.vertices[0]).iter();
        let is_face = star.map(|face| &mesh.faces[face.index()]).any(whole);
        (self.vertices.len() > 3 || !is_face).then_some(faces)
    }

    /// Returns the existing edges between vertices of the hole, as indices around it; `None` if a
    /// vertex has too many faces to search.
    fn edges_between(
        &self,
        mesh: &Mesh,
        connectivity: &Connectivity,
        new_edges: &FxHashSet<[VertexId; 2]>,
    ) -> Option<FxHashSet<[usize; 2]>> {
        const MOST_STAR: usize = 10_000;
        let mut index: Vec<(VertexId, usize)> = self.vertices.iter().copied().zip(0..).collect();
        index.sort_unstable();
        let mut edges = FxHashSet::default();
        for (i, &v) in self.vertices.iter().enumerate() {
            let star = connectivity.star(v);
            if star.len() > MOST_STAR {
                return None;
            }
            let others = star.iter().flat_map(|face| mesh.faces[face.index()]);
            for other in others.filter(|&other| other != v) {
                if let Ok(found) = index.binary_search_by_key(&other, |&(v, _)| v) {
                    edges.insert([i.min(index[found].1), i.max(index[found].1)]);
                }
            }
            for (j, &w) in self.vertices.iter().enumerate().skip(i + 1) {
                if !new_edges.is_empty() && new_edges.contains(&[v.min(w), v.max(w)]) {
                    edges.insert([i, j]);
                }
            }
        }
        Some(edges)
    }

    fn add(&self, mesh: &mut Mesh, faces: &[[usize; 3]], new_edges: &mut FxHashSet<[VertexId; 2]>) {
        for &indices in faces {
            let face = indices.map(|i| self.vertices[i]);
            mesh.faces.push(face);
            for k in 0..3 {
                let [a, b] = [face[k], face[(k + 1) % 3]];
                new_edges.insert([a.min(b), a.max(b)]);
            }
            if let (Some(attributes), Some(wedges)) = (&mut mesh.attributes, &self.wedges) {
                attributes.corners.push(indices.map(|i| wedges[i]));
            }
            repeat_face_values(mesh, self.face);
        }
    }
}

/// Returns the boundary side from one vertex to another.
fn boundary_side(
    mesh: &Mesh,
    connectivity: &Connectivity,
    from: VertexId,
    to: VertexId,
) -> Option<Side> {
    let sides =
        connectivity.star(from).iter().flat_map(|&face| [0, 1, 2].map(|k| Side::new(face, k)));
    sides
        .filter(|side| side.ends(&mesh.faces) == [from, to])
        .find(|&side| connectivity.twin(side) == Twin::Boundary)
}
