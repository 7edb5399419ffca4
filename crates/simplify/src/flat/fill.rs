//! A region's outline, triangulated.

use glam::DVec2;
use meshlod_mesh::{Mesh, VertexId};
use rustc_hash::FxHashMap;
use spade::handles::{DirectedEdgeHandle, FixedFaceHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::flat::NewFace;
use crate::flat::linear::Plane;
use crate::flat::outline::OutlineSide;
use crate::flat::regions::Region;

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;
type MadeEdge<'d> = DirectedEdgeHandle<'d, Point2<f64>, (), spade::CdtEdge<()>, ()>;

/// Outline of a region in its plane. Vertices at one place are one point.
struct Outline {
    points: Vec<Point2<f64>>,
    /// The side that runs from one point to another.
    side: FxHashMap<[usize; 2], usize>,
}

/// Returns the faces of a region with this outline; `None` if it is no outline of a part of the
/// plane: if it crosses or touches itself other than at vertices.
pub(super) fn fill(mesh: &Mesh, region: &Region, sides: &[OutlineSide]) -> Option<Vec<NewFace>> {
    let outline = Outline::new(mesh, Plane::new(region.normal), sides)?;
    let mut is_crossed = false;
    let edges = outline.side.keys().filter(|&&[a, b]| a < b || !outline.side.contains_key(&[b, a]));
    let mut edges: Vec<[usize; 2]> = edges.copied().collect();
    edges.sort_unstable();
    let points = outline.points.clone();
    let made = Delaunay::try_bulk_load_cdt(points, edges, |_| is_crossed = true).ok()?;
    if is_crossed || made.num_vertices() != outline.points.len() {
        return None;
    }
    let outer = outline.outer(&made)?;
    let inside = outline.inside(&made, &outer)?;
    let starts = starts(&made, &outer);
    let face = |face: FixedFaceHandle<InnerTag>| {
        let edges = made.face(face).adjacent_edges();
        let corners = edges.map(|edge| sides.get(starts[edge.fix().index()] as usize));
        let [a, b, c] = corners;
        let [a, b, c] = [a?, b?, c?];
        let vertices = [a.from, b.from, c.from];
        let is_whole = a.from != b.from && b.from != c.from && c.from != a.from;
        let like = region.faces[0];
        is_whole.then_some(NewFace { vertices, wedges: [a.wedge, b.wedge, c.wedge], like })
    };
    inside.into_iter().map(face).collect()
}

impl Outline {
    fn new(mesh: &Mesh, plane: Plane, sides: &[OutlineSide]) -> Option<Self> {
        let mut points = Vec::new();
        let mut at: FxHashMap<[u64; 2], usize> = FxHashMap::default();
        let mut point = |v: VertexId| {
            // The least coordinates would be refused, and -0 is 0.
            let DVec2 { x, y } = plane.place(mesh.positions[v.index()].into());
            let [x, y] = [x, y].map(|x| if x.abs() < f64::MIN_POSITIVE { 0.0 } else { x });
            *at.entry([x.to_bits(), y.to_bits()]).or_insert_with(|| {
                points.push(Point2::new(x, y));
                points.len() - 1
            })
        };
        let mut side = FxHashMap::default();
        for (i, OutlineSide { from, to, .. }) in sides.iter().enumerate() {
            let ends = [from, to].map(|&v| point(v));
            if ends[0] == ends[1] || side.insert(ends, i).is_some() {
                return None;
            }
        }
        Some(Self { points, side })
    }

    /// Returns the sides as edges of the triangulation, each with its number; `None` if one is not an
    /// edge there.
    fn outer<'d>(&self, made: &'d Delaunay) -> Option<Vec<(MadeEdge<'d>, usize)>> {
        let outer = made.directed_edges().filter_map(|edge| {
            let ends = [edge.from(), edge.to()].map(|vertex| vertex.index());
            let side = edge.is_constraint_edge().then(|| self.side.get(&ends)).flatten();
            side.map(|&side| (edge, side))
        });
        let outer: Vec<_> = outer.collect();
        (outer.len() == self.side.len()).then_some(outer)
    }

    /// Returns the faces on the left of the outline; `None` if faces are on both sides of it.
    fn inside(
        &self,
        made: &Delaunay,
        outer: &[(MadeEdge<'_>, usize)],
    ) -> Option<Vec<FixedFaceHandle<InnerTag>>> {
        let mut is_found = vec![false; made.num_all_faces()];
        let mut inside = Vec::new();
        for (edge, _) in outer {
            let mut next = vec![edge.face().as_inner()?.fix()];
            while let Some(face) = next.pop() {
                if std::mem::replace(&mut is_found[face.index()], true) {
                    continue;
                }
                inside.push(face);
                let edges = made.face(face).adjacent_edges();
                for edge in edges.into_iter().filter(|edge| !edge.is_constraint_edge()) {
                    next.push(edge.rev().face().as_inner()?.fix());
                }
            }
        }
        let is_one_sided = outer.iter().all(|(edge, _)| {
            let [from, to] = [edge.from(), edge.to()].map(|vertex| vertex.index());
            let is_beyond = is_found[edge.rev().face().index()];
            is_beyond == self.side.contains_key(&[to, from])
        });
        inside.sort_unstable_by_key(|face| face.index());
        is_one_sided.then_some(inside)
    }
}

/// Returns for each edge of a face inside the side that has the vertex and the wedge at its start:
/// the next one in clockwise order, since several vertices or wedges may be at one point.
fn starts(made: &Delaunay, outer: &[(MadeEdge<'_>, usize)]) -> Vec<u32> {
    let mut starts = vec![u32::MAX; made.num_directed_edges()];
    for &(first, side) in outer {
        let mut edge = first;
        loop {
            starts[edge.fix().index()] = side as u32;
            edge = edge.ccw();
            if edge == first || edge.is_constraint_edge() {
                break;
            }
        }
    }
    starts
}
