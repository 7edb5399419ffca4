//! Keeps triangles from collapsing on the lattice: what is smaller than a cell would have no area.

use crate::implicit::Implicit;

/// In cells of the lattice: whole numbers below 2²⁵, so that nothing is rounded here, but for what is kept to
/// the bit. With such a corner products may be rounded: a sliver that is taken for flat moves a vertex by a
/// few cells for nothing, and what is flat and taken for a sliver has an area for whoever computes it so.
type CellPosition = [f64; 3];

/// Moves of so many cells along each axis are tried, the least first.
const OFFSETS: [f64; 5] = [-2.0, -1.0, 0.0, 1.0, 2.0];
/// How often all flat triangles are gone through.
const MAX_ROUNDS: usize = 16;

/// Moves nodes from the cells they were rounded to, so that no triangle of any cut is without area there
/// that has one without rounding; as far as a few cells do.
///
/// `places` are those of all nodes; `is_free` says which may be moved, `had_area` whether a triangle is to
/// have one.
pub(super) fn unflatten(
    mt: &Implicit,
    places: &mut [CellPosition],
    is_free: impl Fn(u32) -> bool,
    had_area: impl Fn([u32; 3]) -> bool,
) {
    // To keep them takes less time than to make them once more.
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

/// Moves nodes one by one while that makes the triangles at them less flat.
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

/// A node that may move, with all triangles at it.
struct MovableNode<'t> {
    home: CellPosition,
    triangles: &'t [(u32, [u32; 3])],
}

impl MovableNode<'_> {
    /// Moves the node to the closest place where its triangles are least flat, if that is less than now.
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

    /// How flat all triangles are; no more is added up than `most`.
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

/// All moves, the least first.
fn offsets() -> Vec<CellPosition> {
    let all = OFFSETS.into_iter().flat_map(|x| OFFSETS.map(|y| [x, y]));
    let mut all: Vec<CellPosition> = all.flat_map(|[x, y]| OFFSETS.map(|z| [x, y, z])).collect();
    let squared = |offset: &CellPosition| offset.iter().map(|x| x * x).sum::<f64>();
    all.sort_by(|a, b| squared(a).total_cmp(&squared(b)));
    all
}

/// 0 for a triangle with an area, 1 where its corners are on a line, more where some are at one place.
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
