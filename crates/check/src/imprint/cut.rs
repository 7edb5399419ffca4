//! Cutting one face.

use std::collections::BTreeSet;

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

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

/// Whole steps along an edge. Points are only told apart by them; where they are in space is not
/// changed.
const STEPS: u32 = 1 << 30;

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
/// exactly: the parts of the corners. A line that crosses an earlier one is left out.
pub fn cut(cuts: &Cuts) -> Cut {
    let mut triangulation = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let points = whole_points(cuts);
    let handles: Vec<_> = points
        .iter()
        .map(|&[x, y]| triangulation.insert(Point2::new(f64::from(x), f64::from(y))))
        .collect::<Result<_, _>>()
        .expect("whole numbers are fine");
    for line in &cuts.lines {
        let [a, b] = line.map(|point| handles[point]);
        if a != b && triangulation.can_add_constraint(a, b) {
            triangulation.add_constraint(a, b);
        }
    }
    let triangles = triangulation.inner_faces();
    let triangles =
        triangles.map(|face| face.vertices().map(|vertex| vertex.fix().index())).collect();
    let lines = triangulation.undirected_edges().filter(|edge| edge.is_constraint_edge());
    let ends = |ends: [usize; 2]| [ends[0].min(ends[1]), ends[0].max(ends[1])];
    let lines =
        lines.map(|edge| ends(edge.vertices().map(|vertex| vertex.fix().index()))).collect();
    Cut { triangles, lines }
}

/// The points in whole steps, all different, those on edges on them and those inside inside.
fn whole_points(cuts: &Cuts) -> Vec<[u32; 2]> {
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
        let step = |part: f64, most: u32| ((part * f64::from(STEPS)).round() as u32).clamp(1, most);
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
fn whole_steps(along: &[f64]) -> Vec<u32> {
    let mut steps = Vec::with_capacity(along.len());
    let mut last = 0;
    for (i, t) in along.iter().enumerate() {
        let most = STEPS - (along.len() - i) as u32;
        last = ((t * f64::from(STEPS)).round() as u32).clamp(last + 1, most);
        steps.push(last);
    }
    steps
}
