//! Constrained triangulation of a face that is cut by points and segments.

use std::collections::BTreeSet;

use spade::handles::{FixedVertexHandle, VertexHandle};
use spade::{ConstrainedDelaunayTriangulation, HierarchyHintGenerator, Point2, Triangulation};

use crate::check::edges::lowest_first;

/// Constrained Delaunay triangulation with logarithmic point location.
type Delaunay =
    ConstrainedDelaunayTriangulation<Point2<f64>, (), (), (), HierarchyHintGenerator<f64>>;

/// Points and segments at which a face is cut.
///
/// Points are numbered: the three corners, then the points on each edge in the order of the face,
/// then those inside.
#[derive(Debug, Default)]
pub struct FaceCuts {
    /// Parameters of the points on each of the three edges, ascending from 0 to 1.
    pub along: [Vec<f64>; 3],
    /// Barycentric coordinates of the points inside the face, for its second and third corner.
    pub inside: Vec<[f64; 2]>,
    /// Pairs of point numbers that an edge of the triangulation must connect.
    pub segments: Vec<[usize; 2]>,
}

/// Number of grid steps along an edge, as fine as `f64` allows. The grid only serves to
/// triangulate: positions in space are not rounded to it.
const STEPS: u64 = 1 << 52;

/// Triangulation of a face that was cut.
#[derive(Debug, Default)]
pub struct FaceTriangulation {
    /// Triangles as point numbers, oriented like the face.
    pub triangles: Vec<[usize; 3]>,
    /// Edges of the triangulation along the segments, each once, the lower point number first.
    pub segments: Vec<[usize; 2]>,
}

/// Triangulates a face with the given points and segments as vertices and edges.
///
/// The triangulation is Delaunay with the segments as constraints, in barycentric coordinates, in
/// which the points on edges lie on them exactly. Of segments that cross, one is left out.
pub fn triangulate(cuts: &FaceCuts) -> FaceTriangulation {
    let points = grid_points(cuts);
    let order = bisecting_order(points.len());
    let mut triangulation = Delaunay::new();
    let mut handles = vec![FixedVertexHandle::from_index(0); points.len()];
    for &i in &order {
        let [x, y] = points[i].map(|x| x as f64);
        handles[i] = triangulation.insert(Point2::new(x, y)).expect("grid points are finite");
    }
    for segment in bisecting_order(cuts.segments.len()) {
        let [a, b] = cuts.segments[segment].map(|point| handles[point]);
        if a != b && triangulation.can_add_constraint(a, b) {
            triangulation.add_constraint(a, b);
        }
    }
    let point = |vertex: VertexHandle<'_, _, _, _, _>| order[vertex.index()];
    let triangles = triangulation.inner_faces().map(|face| face.vertices().map(point)).collect();
    let segments = triangulation.undirected_edges().filter(|edge| edge.is_constraint_edge());
    let segments = segments.map(|edge| lowest_first(edge.vertices().map(point)));
    FaceTriangulation { triangles, segments: segments.collect() }
}

/// Returns the numbers below `count` in bit-reversed order, which bisects the range again and
/// again.
///
/// Inserted in sequence, each point would flip many edges again: 10,000 parallel segments took 16
/// s, and take 1 s in this order.
fn bisecting_order(count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|i| i.reverse_bits());
    order
}

/// Rounds the points to distinct grid points, keeping those on an edge on it and those inside
/// inside.
fn grid_points(cuts: &FaceCuts) -> Vec<[u64; 2]> {
    let mut points = vec![[0, 0], [STEPS, 0], [0, STEPS]];
    for (edge, along) in cuts.along.iter().enumerate() {
        let steps = grid_steps(along);
        points.extend(steps.into_iter().map(|t| match edge {
            0 => [t, 0],
            1 => [STEPS - t, t],
            _ => [0, STEPS - t],
        }));
    }
    let mut taken = BTreeSet::new();
    for &[x, y] in &cuts.inside {
        let step = |part: f64, most: u64| ((part * STEPS as f64).round() as u64).clamp(1, most);
        let x = step(x, STEPS - 2);
        let mut point = [x, step(y, STEPS - 1 - x)];
        // A taken grid point is replaced by the next free one, scanning across the face.
        while !taken.insert(point) {
            point[1] = if point[0] + point[1] < STEPS - 1 { point[1] + 1 } else { 1 };
        }
        points.push(point);
    }
    points
}

/// Rounds ascending parameters to strictly ascending steps from 1 to `STEPS - 1`.
fn grid_steps(along: &[f64]) -> Vec<u64> {
    let mut steps = Vec::with_capacity(along.len());
    let mut last = 0;
    for (i, t) in along.iter().enumerate() {
        let most = STEPS - (along.len() - i) as u64;
        last = ((t * STEPS as f64).round() as u64).clamp(last + 1, most);
        steps.push(last);
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_polygon_in_a_large_face_is_cut_correctly() {
        let size = 1e-10;
        let inside: Vec<_> = [[0.0, 0.0], [1.0, 0.3], [0.4, 0.9], [-0.5, 0.6], [-0.2, -0.8]]
            .map(|[x, y]| [0.3 + size * x, 0.4 + size * y])
            .to_vec();
        let points: Vec<_> =
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].into_iter().chain(inside.clone()).collect();
        let segments = (3..8).map(|i| [i, if i == 7 { 3 } else { i + 1 }]).collect();
        let cut = triangulate(&FaceCuts { inside, segments, ..FaceCuts::default() });
        assert_eq!((cut.triangles.len(), cut.segments.len()), (11, 5));
        for [a, b, c] in cut.triangles.iter().map(|triangle| triangle.map(|i| points[i])) {
            let turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert!(turn > 0.0, "{a:?} {b:?} {c:?}");
        }
    }
}
