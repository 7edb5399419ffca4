//! Repair of triangles that rounding to the lattice has collapsed to a line or a point.

use crate::forest::Forest;
use crate::implicit::Order;

/// Position in cells of the lattice.
///
/// Coordinates are whole numbers below 2²⁵, for which the arithmetic here is exact. Only an exact
/// position of the input has others. With such a corner, a sliver may be taken for degenerate,
/// which moves a vertex by a few cells without need, or a degenerate triangle for a sliver, which
/// then has an area for anyone who computes it in the same way.
type CellPosition = [f64; 3];

/// Offsets tried along each axis, in cells.
const OFFSETS: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];
/// Upper limit on the passes over all movable nodes.
const MAX_ROUNDS: usize = 16;

/// Moves nodes by up to a few cells so that, where possible, no triangle of any cut loses its area
/// to rounding.
///
/// `places` holds the positions of all nodes, `unrounded` returns one before rounding, `is_free`
/// tells which of them may be moved, and `had_area` whether a triangle had an area before rounding.
pub(super) fn unflatten(
    forest: &Forest,
    places: &mut [CellPosition],
    unrounded: impl Fn(u32) -> CellPosition,
    is_free: impl Fn(u32) -> bool,
    had_area: impl Fn([u32; 3]) -> bool,
) {
    let mut is_movable = vec![false; places.len()];
    forest.each_triangle(|nodes| {
        if flatness(nodes.map(|n| places[n as usize])) > 0 && had_area(nodes) {
            nodes.iter().for_each(|&node| is_movable[node as usize] = is_free(node));
        }
    });
    if !is_movable.contains(&true) {
        return;
    }
    // All triangles would take 84 bytes for each face of the finest mesh: they are enumerated twice.
    let order = Order::new(forest);
    let mut at: Vec<(u32, [u32; 3])> = Vec::new();
    forest.each_triangle(|nodes| {
        let movable = nodes.into_iter().filter(|&node| is_movable[node as usize]);
        at.extend(movable.map(|node| (order.index_of_node[node as usize], nodes)));
    });
    at.sort_unstable();
    let offsets = offsets();
    let movable = at.chunk_by(|a, b| a.0 == b.0).map(|triangles| {
        let node = order.nodes[triangles[0].0 as usize];
        MovableNode::new((node, triangles), places[node as usize], unrounded(node), &offsets)
    });
    solve(&movable.collect::<Vec<_>>(), places);
}

/// Moves nodes one by one until no move makes their triangles less degenerate.
fn solve(movable: &[MovableNode<'_>], places: &mut [CellPosition]) {
    for _ in 0..MAX_ROUNDS {
        let moved = movable.iter().filter(|node| node.improve(places)).count();
        if moved == 0 {
            break;
        }
    }
}

/// Node that may move, with all its triangles.
struct MovableNode<'t> {
    node: u32,
    triangles: &'t [(u32, [u32; 3])],
    /// Positions to try, those nearest to the position before rounding first.
    choices: Vec<CellPosition>,
}

impl<'t> MovableNode<'t> {
    fn new(
        (node, triangles): (u32, &'t [(u32, [u32; 3])]),
        rounded: CellPosition,
        unrounded: CellPosition,
        offsets: &[CellPosition],
    ) -> Self {
        let add = |offset: &CellPosition| [0, 1, 2].map(|k| rounded[k] + offset[k]);
        let mut choices: Vec<CellPosition> = offsets.iter().map(add).collect();
        let away = |at: &CellPosition| (0..3).map(|k| (at[k] - unrounded[k]).powi(2)).sum::<f64>();
        choices.sort_by(|a, b| away(a).total_cmp(&away(b)));
        Self { node, triangles, choices }
    }

    /// Moves the node to the nearest position at which its triangles are least degenerate. Returns
    /// true if that is an improvement.
    fn improve(&self, places: &mut [CellPosition]) -> bool {
        let node = self.node as usize;
        let (mut best, mut least) = (places[node], self.flatness(places, u32::MAX));
        let before = least;
        for choice in &self.choices {
            if least == 0 {
                break;
            }
            places[node] = *choice;
            let flatness = self.flatness(places, least);
            if flatness < least {
                (best, least) = (places[node], flatness);
            }
        }
        places[node] = best;
        least < before
    }

    /// Sums the degeneracy of all triangles, and stops once it reaches `most`.
    fn flatness(&self, places: &[CellPosition], most: u32) -> u32 {
        let mut all = 0;
        for (_, nodes) in self.triangles {
            all += flatness(nodes.map(|n| places[n as usize]));
            if all >= most {
                break;
            }
        }
        all
    }
}

/// Returns all combinations of offsets.
fn offsets() -> Vec<CellPosition> {
    let all = OFFSETS.into_iter().flat_map(|x| OFFSETS.map(|y| [x, y]));
    all.flat_map(|[x, y]| OFFSETS.map(|z| [x, y, z])).collect()
}

/// Degree of degeneracy: 0 for a triangle with an area, 1 if its corners are collinear, more if
/// some coincide.
#[inline]
fn flatness([a, b, c]: [CellPosition; 3]) -> u32 {
    // Corners that coincide are collinear.
    if !are_collinear([a, b, c]) {
        return 0;
    }
    match [a == b, b == c, c == a].into_iter().filter(|&same| same).count() {
        0 => 1,
        1 => 2,
        _ => 4,
    }
}

#[inline]
fn are_collinear([a, b, c]: [CellPosition; 3]) -> bool {
    let from_a = |p: CellPosition| [0, 1, 2].map(|k| p[k] - a[k]);
    let (u, v) = (from_a(b), from_a(c));
    (0..3).all(|k| u[k] * v[(k + 1) % 3] == u[(k + 1) % 3] * v[k])
}
