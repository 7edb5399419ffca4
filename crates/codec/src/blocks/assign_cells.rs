//! Assignment of vertices to cells, which need not be the closest ones.
//!
//! Where the surface is bent, a neighbouring cell may leave the planes of a vertex's faces by less
//! than the closest one. Each vertex takes the cell around it with the least mean square distance
//! of its faces to their planes, with all other vertices fixed: iterated conditional modes [Bes86].

use glam::DVec3;
use rayon::prelude::*;

use super::deviation::{Limits, Neighbourhood};
use super::move_cost::{Hinge, MoveCost, Moves};
use super::original::OriginalSurface;
use crate::kd::BLOCK;

/// Cells of a block.
pub(super) struct BlockGrid {
    pub(super) sides: [DVec3; 3],
    /// Middle of the first cell.
    pub(super) first: DVec3,
    /// Number of cells along each axis.
    pub(super) counts: [i32; 3],
}

/// The cell of each vertex.
pub(super) struct CellAssignment {
    pub(super) cells: Vec<[i32; 3]>,
    /// Displacement of each vertex from its original position.
    pub(super) moved: Vec<DVec3>,
}

/// Parameters of the assignment.
pub(super) struct AssignOptions {
    /// Cost of moving along the surface, relative to moving across it.
    pub(super) along: f64,
    /// Distance from the planes of its faces beyond which a vertex is penalized.
    pub(super) limit: f64,
    /// Number of passes over all vertices.
    pub(super) sweeps: usize,
}

/// Blocks that are assigned one after the other, so that each sees what the one before has done.
/// Chunks of this size have a twentieth of their vertices on their borders.
const CHUNK: usize = 256;

impl BlockGrid {
    /// Returns the fractional cell coordinates of a point.
    fn at(&self, place: DVec3) -> [f64; 3] {
        let away = place - self.first;
        self.sides.map(|side| away.dot(side) / side.length_squared())
    }

    fn place(&self, cell: [i32; 3]) -> DVec3 {
        let [u, v, w] = cell.map(f64::from);
        self.first + self.sides[0] * u + self.sides[1] * v + self.sides[2] * w
    }

    /// Converts a rounded coordinate along an axis to a cell of the grid, by clamping.
    fn within(&self, axis: usize, x: f64) -> i32 {
        (x as i32).clamp(0, self.counts[axis] - 1)
    }
}

impl CellAssignment {
    /// Starts with all vertices unassigned.
    pub(super) fn new(surface: &OriginalSurface) -> Self {
        let count = surface.places.len();
        Self { cells: vec![[0; 3]; count], moved: vec![DVec3::ZERO; count] }
    }

    /// Assigns each vertex of some blocks to its closest cell, then in several passes to the
    /// neighbouring cell with the least cost.
    ///
    /// `blocks` are sorted. In parallel, with the same result for any number of threads.
    pub(super) fn assign(
        &mut self,
        surface: &OriginalSurface,
        grids: &[BlockGrid],
        options: &AssignOptions,
        blocks: &[usize],
    ) {
        self.for_chunks(blocks, |v, cell, moves, _| {
            let (grid, place) = (&grids[v / BLOCK], surface.places[v]);
            let at = grid.at(place);
            *cell = [0, 1, 2].map(|k| grid.within(k, at[k].round()));
            moves.own[v - moves.start] = grid.place(*cell) - place;
        });
        for _ in 0..options.sweeps {
            self.for_chunks(blocks, |v, cell, moves, hinges| {
                assign_one(surface, &grids[v / BLOCK], v, options, (cell, moves, hinges));
            });
        }
    }

    /// Visits the vertices of some blocks, chunk by chunk, with their cells and room for hinges.
    fn for_chunks(
        &mut self,
        blocks: &[usize],
        visit: impl Fn(usize, &mut [i32; 3], &mut Moves, &mut Vec<Hinge>) + Sync,
    ) {
        let before = self.moved.clone();
        let size = CHUNK * BLOCK;
        let chunks = self.cells.par_chunks_mut(size).zip(self.moved.par_chunks_mut(size));
        chunks.enumerate().for_each(|(chunk, (cells, own))| {
            let up_to = |end: usize| blocks.partition_point(|&block| block < end);
            let blocks = &blocks[up_to(chunk * CHUNK)..up_to((chunk + 1) * CHUNK)];
            let (start, end) = (chunk * size, chunk * size + own.len());
            let mut moves = Moves { before: &before, start, own };
            let mut hinges = Vec::new();
            let vertices = |&block: &usize| block * BLOCK..((block + 1) * BLOCK).min(end);
            for v in blocks.iter().flat_map(vertices) {
                visit(v, &mut cells[v - start], &mut moves, &mut hinges);
            }
        });
    }

    /// Returns those of the vertices that are farther than `most` from the surface.
    pub(super) fn far(
        &self,
        surface: &OriginalSurface,
        most: f64,
        vertices: &[usize],
    ) -> Vec<usize> {
        let limits = Limits { enough: most, most: f64::INFINITY };
        let is_far = |&v: &usize| surface.deviation(v, &self.moved, limits) > most;
        vertices.par_iter().copied().filter(is_far).collect()
    }

    /// Moves vertices that are farther than `most` from the surface, and such neighbours of them,
    /// to better cells. Returns those that stay too far.
    pub(super) fn repair(
        &mut self,
        surface: &OriginalSurface,
        grids: &[BlockGrid],
        most: f64,
        far: Vec<usize>,
    ) -> Vec<usize> {
        let limits = Limits { enough: most, most: f64::INFINITY };
        // One that is moved changes the faces of those around it.
        let mut far = surface.with_neighbours(far.into_iter());
        far.retain(|&v| {
            if surface.is_near(v, &self.moved, most) {
                return false;
            }
            let hood = Neighbourhood::new(surface, v);
            let is = hood.deviation(&self.moved, limits);
            is > most && self.repair_one(surface, &grids[v / BLOCK], &hood, is, most) > most
        });
        far
    }

    /// Moves the vertex of a neighbourhood to the cell around it with the fewest flipped faces and
    /// the least deviation, now `deviation`, and returns that. Any cell within `enough` will do.
    fn repair_one(
        &mut self,
        surface: &OriginalSurface,
        grid: &BlockGrid,
        hood: &Neighbourhood,
        deviation: f64,
        enough: f64,
    ) -> f64 {
        let v = hood.vertex;
        let at = grid.at(surface.places[v]);
        // The closest cells first: any that is near enough will do.
        let range = |k: usize| [0.0, 1.0, -1.0, 2.0].map(|by| grid.within(k, at[k].floor() + by));
        let mut best = ((flips(surface, v, &self.moved), deviation), self.cells[v], self.moved[v]);
        let [across, along, beside] = [2, 1, 0].map(range);
        let cells = across.iter().flat_map(|&c| along.iter().map(move |&b| (b, c)));
        for cell in cells.flat_map(|(b, c)| beside.iter().map(move |&a| [a, b, c])) {
            self.moved[v] = grid.place(cell) - surface.places[v];
            let flips = flips(surface, v, &self.moved);
            if flips > best.0.0 {
                continue;
            }
            let most = if flips < best.0.0 { f64::INFINITY } else { best.0.1 };
            let cost = (flips, hood.deviation(&self.moved, Limits { enough, most }));
            if cost < best.0 {
                best = (cost, cell, self.moved[v]);
            }
            if best.0 == (0, 0.0) {
                break;
            }
        }
        (self.cells[v], self.moved[v]) = (best.1, best.2);
        best.0.1
    }
}

/// Moves a vertex to the cell around it with the least cost.
fn assign_one(
    surface: &OriginalSurface,
    grid: &BlockGrid,
    v: usize,
    options: &AssignOptions,
    (cell, moves, hinges): (&mut [i32; 3], &mut Moves, &mut Vec<Hinge>),
) {
    let judge = MoveCost::new(surface, grid, v, moves, options, hinges);
    let place = surface.places[v];
    let at = grid.at(place);
    let moved = moves.of(v);
    let mut best = (judge.cost(moved), *cell, moved);
    // To mend flipped faces, look one cell farther.
    let (from, to, beside) = if best.0.0 == 0 { (0.0, 1.0, 0) } else { (-1.0, 2.0, 1) };
    let range =
        |k: usize| grid.within(k, at[k].floor() + from)..=grid.within(k, at[k].floor() + to);
    for a in range(0) {
        for b in range(1) {
            let base = grid.place([a, b, 0]) - place;
            let c = judge.best_along(grid.sides[2], base).unwrap_or(at[2]).round();
            for c in grid.within(2, c) - beside..=grid.within(2, c) + beside {
                let c = c.clamp(0, grid.counts[2] - 1);
                let moved = base + grid.sides[2] * f64::from(c);
                if let Some(cost) = judge.less(moved, best.0) {
                    best = (cost, [a, b, c], moved);
                }
            }
        }
    }
    (*cell, moves.own[v - moves.start]) = (best.1, best.2);
}

/// Returns the number of flipped faces around a vertex.
fn flips(surface: &OriginalSurface, v: usize, moved: &[DVec3]) -> usize {
    surface.faces_around(v).filter(|face| surface.is_flipped(face, moved)).count()
}
