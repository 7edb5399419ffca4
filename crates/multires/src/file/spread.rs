//! Keeps triangles from collapsing on the lattice: what is smaller than a cell would have no area.

use std::collections::BTreeMap;

use crate::implicit::Implicit;

/// A place on the lattice.
type Cell = [i32; 3];

/// Moves of this many cells along each axis are tried, the least first.
const FARTHEST: i32 = 2;
/// How often all flat triangles are gone through.
const ROUNDS: usize = 16;

/// Nodes to be moved from where they were rounded to, so that no triangle of any cut is without area
/// on the lattice that has one without it; as far as a few cells do. `cells` are the places of all
/// nodes, and `had_area` says whether a triangle is to have one.
pub(super) fn spread(
    mt: &Implicit,
    cells: &[Cell],
    had_area: impl Fn([u32; 3]) -> bool,
) -> BTreeMap<u32, Cell> {
    // To keep them takes less time than to make them once more.
    let mut all = Vec::new();
    mt.each_triangle(|nodes| all.push(nodes));
    let mut movable = vec![false; cells.len()];
    for nodes in &all {
        if flatness(nodes.map(|n| cells[n as usize])) > 0 && had_area(*nodes) {
            nodes.iter().for_each(|&node| movable[node as usize] = true);
        }
    }
    Patch::new(cells, &all, &movable).solve()
}

/// The triangles at the nodes that may move.
struct Patch<'c> {
    cells: &'c [Cell],
    moved: BTreeMap<u32, Cell>,
    at: BTreeMap<u32, Vec<[u32; 3]>>,
}

impl<'c> Patch<'c> {
    fn new(cells: &'c [Cell], all: &[[u32; 3]], movable: &[bool]) -> Self {
        let mut at: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
        for nodes in all {
            for &node in nodes.iter().filter(|&&node| movable[node as usize]) {
                at.entry(node).or_default().push(*nodes);
            }
        }
        Self { cells, moved: BTreeMap::new(), at }
    }

    /// Moves nodes one by one while that makes triangles less flat.
    fn solve(mut self) -> BTreeMap<u32, Cell> {
        let nodes: Vec<u32> = self.at.keys().copied().collect();
        let steps = steps();
        for _ in 0..ROUNDS {
            let mut is_better = false;
            for &node in &nodes {
                let now = self.flatness_at(node, self.cell(node));
                if now == 0 {
                    continue;
                }
                let home = self.cells[node as usize];
                let tried = steps.iter().map(|step| [0, 1, 2].map(|k| home[k] + step[k]));
                let best = tried.min_by_key(|&cell| self.flatness_at(node, cell));
                if let Some(cell) = best.filter(|&cell| self.flatness_at(node, cell) < now) {
                    self.moved.insert(node, cell);
                    is_better = true;
                }
            }
            if !is_better {
                break;
            }
        }
        self.moved
    }

    fn cell(&self, node: u32) -> Cell {
        self.moved.get(&node).copied().unwrap_or(self.cells[node as usize])
    }

    /// How flat the triangles at a node would be if it were there.
    fn flatness_at(&self, node: u32, cell: Cell) -> u32 {
        let place = |n: u32| if n == node { cell } else { self.cell(n) };
        self.at[&node].iter().map(|nodes| flatness(nodes.map(place))).sum()
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
