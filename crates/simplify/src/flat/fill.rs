//! A region's outline, triangulated.

use glam::DVec2;
use meshlod_mesh::{Mesh, VertexId, WedgeId};
use rustc_hash::{FxHashMap, FxHashSet};
use spade::handles::{DirectedEdgeHandle, FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::flat::NewFace;
use crate::flat::linear::Plane;
use crate::flat::outline::OutlineSide;
use crate::flat::regions::Region;

type Delaunay = ConstrainedDelaunayTriangulation<Point2<f64>>;
type MadeEdge<'d> = DirectedEdgeHandle<'d, Point2<f64>, (), spade::CdtEdge<()>, ()>;

/// Outline of a region in its plane. Vertices at one place are one point.
struct Outline<'s> {
    sides: &'s [OutlineSide],
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
    let inside = outline.inside(&made)?;
    let face = |face: FixedFaceHandle<InnerTag>| {
        let corners = made.face(face).adjacent_edges().map(|edge| outline.corner(edge));
        let [a, b, c] = corners;
        let [a, b, c] = [a?, b?, c?];
        let vertices = [a.0, b.0, c.0];
        let is_whole = a.0 != b.0 && b.0 != c.0 && c.0 != a.0;
        let like = region.faces[0];
        is_whole.then_some(NewFace { vertices, wedges: [a.1, b.1, c.1], like })
    };
    inside.into_iter().map(face).collect()
}

impl<'s> Outline<'s> {
    fn new(mesh: &Mesh, plane: Plane, sides: &'s [OutlineSide]) -> Option<Self> {
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
        Some(Self { sides, points, side })
    }

    /// Returns the faces on the left of the outline; `None` if it is no edges of the triangulation,
    /// or faces are on both sides of it.
    fn inside(&self, made: &Delaunay) -> Option<Vec<FixedFaceHandle<InnerTag>>> {
        let edge = |&[a, b]: &[usize; 2]| {
            let [a, b] = [a, b].map(FixedVertexHandle::from_index);
            made.get_edge_from_neighbors(a, b).filter(|edge| edge.is_constraint_edge())
        };
        let mut ends: Vec<&[usize; 2]> = self.side.keys().collect();
        ends.sort_unstable();
        let outer = ends.into_iter().map(edge).collect::<Option<Vec<MadeEdge<'_>>>>()?;
        let mut found = FxHashSet::default();
        let mut inside = Vec::new();
        for edge in &outer {
            let mut next = vec![edge.face().as_inner()?.fix()];
            while let Some(face) = next.pop() {
                if !found.insert(face) {
                    continue;
                }
                inside.push(face);
                let edges = made.face(face).adjacent_edges();
                for edge in edges.into_iter().filter(|edge| !edge.is_constraint_edge()) {
                    next.push(edge.rev().face().as_inner()?.fix());
                }
            }
        }
        let is_one_sided = outer.iter().all(|edge| {
            let [from, to] = [edge.from(), edge.to()].map(|vertex| vertex.index());
            let is_beyond = edge.rev().face().as_inner().is_some_and(|f| found.contains(&f.fix()));
            is_beyond == self.side.contains_key(&[to, from])
        });
        inside.sort_unstable_by_key(|face| face.index());
        is_one_sided.then_some(inside)
    }

    /// Returns the vertex and wedge at the start of an edge of a face: those of the next side of the
    /// outline in clockwise order, since several vertices or wedges may be at one point.
    fn corner(&self, start: MadeEdge<'_>) -> Option<(VertexId, WedgeId)> {
        let mut edge = start;
        loop {
            let ends = [edge.from(), edge.to()].map(|vertex| vertex.index());
            if let Some(&side) = self.side.get(&ends) {
                let OutlineSide { from, wedge, .. } = self.sides[side];
                return Some((from, wedge));
            }
            edge = edge.cw();
            if edge == start {
                return None;
            }
        }
    }
}
