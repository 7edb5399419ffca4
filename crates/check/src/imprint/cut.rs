//! Cutting one face.

use std::collections::BTreeSet;

use spade::handles::{FixedVertexHandle, VertexHandle};
use spade::{ConstrainedDelaunayTriangulation, HierarchyHintGenerator, Point2, Triangulation};

use crate::check::edges::lowest_first;

/// Finds where a point is in a time that hardly grows.
type Triangles =
    ConstrainedDelaunayTriangulation<Point2<f64>, (), (), (), HierarchyHintGenerator<f64>>;

/// What a face is cut by. Points are numbered: the three corners, the points on the edge from the
/// first corner, on the next, on the last, each as the face goes round, and those inside.
#[derive(Debug, Default)]
pub struct Cuts {
    /// How far along its edge each is, from 0 to 1, in order.
    pub along: [Vec<f64>; 3],
    /// The parts of the second and the third corner in each.
    pub inside: Vec<[f64; 2]>,
    /// Pairs of points that shall be edges.
    pub lines: Vec<[usize; 2]>,
}

/// Whole steps along an edge, as many as `f64` tells apart. Points are only told apart by them; where
/// they are in space is not changed.
const STEPS: u64 = 1 << 52;

/// What a face is cut into.
#[derive(Debug, Default)]
pub struct Cut {
    /// Triangles by points, turned as the face is.
    pub triangles: Vec<[usize; 3]>,
    /// The edges along which lines run, each once, the lower point first.
    pub lines: Vec<[usize; 2]>,
}

/// The triangles of a face.
///
/// Delaunay with the lines as constraints, in coordinates in which the points on edges are on them
/// exactly: the parts of the corners. Of lines that cross, one is left out.
pub fn cut(cuts: &Cuts) -> Cut {
    let points = whole_points(cuts);
    let order = halving(points.len());
    let mut triangulation = Triangles::new();
    let mut handles = vec![FixedVertexHandle::from_index(0); points.len()];
    for &i in &order {
        let [x, y] = points[i].map(|x| x as f64);
        handles[i] = triangulation.insert(Point2::new(x, y)).expect("whole numbers are fine");
    }
    for line in halving(cuts.lines.len()) {
        let [a, b] = cuts.lines[line].map(|point| handles[point]);
        if a != b && triangulation.can_add_constraint(a, b) {
            triangulation.add_constraint(a, b);
        }
    }
    let point = |vertex: VertexHandle<'_, _, _, _, _>| order[vertex.index()];
    let triangles = triangulation.inner_faces().map(|face| face.vertices().map(point)).collect();
    let lines = triangulation.undirected_edges().filter(|edge| edge.is_constraint_edge());
    let lines = lines.map(|edge| lowest_first(edge.vertices().map(point)));
    Cut { triangles, lines: lines.collect() }
}

/// Numbers in an order that halves and halves again. What comes row by row would be turned over again
/// for each: 10,000 lines side by side took 16 s, so they take one.
fn halving(count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|i| i.reverse_bits());
    order
}

/// The points in whole steps, all different, those on edges on them and those inside inside.
fn whole_points(cuts: &Cuts) -> Vec<[u64; 2]> {
    let mut points = vec![[0, 0], [STEPS, 0], [0, STEPS]];
    for (edge, along) in cuts.along.iter().enumerate() {
        let steps = whole_steps(along);
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
        // What is too near goes to the next free one, across the face and round again.
        while !taken.insert(point) {
            point[1] = if point[0] + point[1] < STEPS - 1 { point[1] + 1 } else { 1 };
        }
        points.push(point);
    }
    points
}

/// Whole steps from 1 to all but one, rising.
fn whole_steps(along: &[f64]) -> Vec<u64> {
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
    fn what_is_small_in_a_large_face_is_cut_as_it_lies() {
        let size = 1e-10;
        let inside: Vec<_> = [[0.0, 0.0], [1.0, 0.3], [0.4, 0.9], [-0.5, 0.6], [-0.2, -0.8]]
            .map(|[x, y]| [0.3 + size * x, 0.4 + size * y])
            .to_vec();
        let points: Vec<_> =
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].into_iter().chain(inside.clone()).collect();
        let lines = (3..8).map(|i| [i, if i == 7 { 3 } else { i + 1 }]).collect();
        let cut = cut(&Cuts { inside, lines, ..Cuts::default() });
        assert_eq!((cut.triangles.len(), cut.lines.len()), (11, 5));
        for [a, b, c] in cut.triangles.iter().map(|triangle| triangle.map(|i| points[i])) {
            let turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert!(turn > 0.0, "{a:?} {b:?} {c:?}");
        }
    }
}
