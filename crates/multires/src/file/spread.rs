//! Keeps triangles from collapsing on the lattice: what is smaller than a cell would have no area.

use crate::implicit::Implicit;

/// A place on the lattice.
type Cell = [i32; 3];

/// Moves of this many cells along each axis are tried, the least first.
const FARTHEST: i32 = 2;
/// How often all flat triangles are gone through.
const ROUNDS: usize = 16;

/// Moves nodes from the cells they were rounded to, so that no triangle of any cut is without area on
/// the lattice that has one without it; as far as a few cells do.
///
/// `cells` are those of all nodes; `had_area` says whether a triangle is to have one.
pub(super) fn spread(mt: &Implicit, cells: &mut [Cell], had_area: impl Fn([u32; 3]) -> bool) {
    // To keep them takes less time than to make them once more.
    let mut all = Vec::new();
    mt.each_triangle(|nodes| all.push(nodes));
    let mut is_movable = vec![false; cells.len()];
    for nodes in &all {
        if flatness(nodes.map(|n| cells[n as usize])) > 0 && had_area(*nodes) {
            nodes.iter().for_each(|&node| is_movable[node as usize] = true);
        }
    }
    let mut at: Vec<(u32, [u32; 3])> = Vec::new();
    for nodes in all {
        let movable = nodes.into_iter().filter(|&node| is_movable[node as usize]);
        at.extend(movable.map(|node| (node, nodes)));
    }
    at.sort_unstable();
    solve(&at, cells);
}

/// Moves nodes one by one while that makes the triangles at them less flat.
fn solve(at: &[(u32, [u32; 3])], cells: &mut [Cell]) {
    let stars: Vec<Star<'_>> = at
        .chunk_by(|a, b| a.0 == b.0)
        .map(|triangles| Star { home: cells[triangles[0].0 as usize], triangles })
        .collect();
    let steps = steps();
    for _ in 0..ROUNDS {
        let moved = stars.iter().filter(|star| star.improve(&steps, cells)).count();
        if moved == 0 {
            break;
        }
    }
}

/// A node that may move, with all triangles at it.
struct Star<'t> {
    home: Cell,
    triangles: &'t [(u32, [u32; 3])],
}

impl Star<'_> {
    /// Moves the node to the closest place where its triangles are least flat, if that is less than now.
    fn improve(&self, steps: &[Cell], cells: &mut [Cell]) -> bool {
        let node = self.triangles[0].0 as usize;
        let (mut best, mut least) = (cells[node], self.flatness(cells, u32::MAX));
        let before = least;
        for step in steps {
            if least == 0 {
                break;
            }
            cells[node] = [0, 1, 2].map(|k| self.home[k] + step[k]);
            let flatness = self.flatness(cells, least);
            if flatness < least {
                (best, least) = (cells[node], flatness);
            }
        }
        cells[node] = best;
        least < before
    }

    /// How flat all triangles are; no more is added up than `most`.
    fn flatness(&self, cells: &[Cell], most: u32) -> u32 {
        let mut all = 0;
        for (_, nodes) in self.triangles {
            all += flatness(nodes.map(|n| cells[n as usize]));
            if all >= most {
                break;
            }
        }
        all
    }
}

/// All moves, the least first.
fn steps() -> Vec<Cell> {
    let along = -FARTHEST..=FARTHEST;
    let all = along.clone().flat_map(|x| along.clone().map(move |y| [x, y]));
    let mut all: Vec<Cell> = all.flat_map(|[x, y]| along.clone().map(move |z| [x, y, z])).collect();
    all.sort_by_key(|step| step.iter().map(|x| x * x).sum::<i32>());
    all
}

/// 0 for a triangle with an area, 1 where its corners are on a line, more where some are at one place.
fn flatness([a, b, c]: [Cell; 3]) -> u32 {
    match [a == b, b == c, c == a].into_iter().filter(|&same| same).count() {
        0 => u32::from(is_line([a, b, c])),
        1 => 2,
        _ => 4,
    }
}

fn is_line([a, b, c]: [Cell; 3]) -> bool {
    let from_a = |p: Cell| [0, 1, 2].map(|k| i64::from(p[k]) - i64::from(a[k]));
    let (u, v) = (from_a(b), from_a(c));
    (0..3).all(|k| u[k] * v[(k + 1) % 3] == u[(k + 1) % 3] * v[k])
}
