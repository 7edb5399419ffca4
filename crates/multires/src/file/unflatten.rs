//! Repair of triangles that rounding to the lattice has collapsed to a line or a point.

use crate::implicit::Implicit;

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
/// `places` holds the positions of all nodes, `is_free` tells which of them may be moved, and
/// `had_area` whether a triangle had an area before rounding.
pub(super) fn unflatten(
    mt: &Implicit,
    places: &mut [CellPosition],
    is_free: impl Fn(u32) -> bool,
    had_area: impl Fn([u32; 3]) -> bool,
) {
    // Storing the triangles is faster than enumerating them twice.
    let mut all = Vec::new();
    mt.each_triangle(|nodes| all.push(nodes));
    let mut is_movable = vec![false; places.len()];
    for nodes in &all {
        if flatness(nodes.map(|n| places[n as usize])) > 0 && had_area(*nodes) {
            nodes.iter().for_each(|&node| is_movable[node as usize] = is_free(node));
        }
    }
    let mut at: Vec<(u32, [u32; 3])> = Vec::new();
    for nodes in all {
        let movable = nodes.into_iter().filter(|&node| is_movable[node as usize]);
        at.extend(movable.map(|node| (node, nodes)));
    }
    at.sort_unstable();
    solve(&at, places);
}

/// Moves nodes one by one until no move makes their triangles less degenerate.
fn solve(at: &[(u32, [u32; 3])], places: &mut [CellPosition]) {
    let movable: Vec<MovableNode<'_>> = at
        .chunk_by(|a, b| a.0 == b.0)
        .map(|triangles| MovableNode { home: places[triangles[0].0 as usize], triangles })
        .collect();
    let offsets = offsets();
    for _ in 0..MAX_ROUNDS {
        let moved = movable.iter().filter(|node| node.improve(&offsets, places)).count();
        if moved == 0 {
            break;
        }
    }
}

/// Node that may move, with all its triangles.
struct MovableNode<'t> {
    home: CellPosition,
    triangles: &'t [(u32, [u32; 3])],
}

impl MovableNode<'_> {
    /// Moves the node to the closest position at which its triangles are least degenerate. Returns
    /// true if that is an improvement.
    fn improve(&self, offsets: &[CellPosition], places: &mut [CellPosition]) -> bool {
        let node = self.triangles[0].0 as usize;
        let (mut best, mut least) = (places[node], self.flatness(places, u32::MAX));
        let before = least;
        for offset in offsets {
            if least == 0 {
                break;
            }
            places[node] = [0, 1, 2].map(|k| self.home[k] + offset[k]);
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

/// Returns all combinations of offsets, shortest first.
fn offsets() -> Vec<CellPosition> {
    let all = OFFSETS.into_iter().flat_map(|x| OFFSETS.map(|y| [x, y]));
    let mut all: Vec<CellPosition> = all.flat_map(|[x, y]| OFFSETS.map(|z| [x, y, z])).collect();
    let squared = |offset: &CellPosition| offset.iter().map(|x| x * x).sum::<f64>();
    all.sort_by(|a, b| squared(a).total_cmp(&squared(b)));
    all
}

/// Degree of degeneracy: 0 for a triangle with an area, 1 if its corners are collinear, more if
/// some coincide.
fn flatness([a, b, c]: [CellPosition; 3]) -> u32 {
    match [a == b, b == c, c == a].into_iter().filter(|&same| same).count() {
        0 => u32::from(are_collinear([a, b, c])),
        1 => 2,
        _ => 4,
    }
}

fn are_collinear([a, b, c]: [CellPosition; 3]) -> bool {
    let from_a = |p: CellPosition| [0, 1, 2].map(|k| p[k] - a[k]);
    let (u, v) = (from_a(b), from_a(c));
    (0..3).all(|k| u[k] * v[(k + 1) % 3] == u[(k + 1) % 3] * v[k])
}
