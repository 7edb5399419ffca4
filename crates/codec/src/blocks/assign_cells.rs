//! Assignment of vertices to cells, which need not be the closest ones.
//!
//! Where the surface is bent, a neighbouring cell may leave the planes of a vertex's faces by less
//! than the closest one. Each vertex takes the cell around it with the least mean square distance
//! of its faces to their planes, with all other vertices fixed: iterated conditional modes [Bes86].

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use super::deviation::{Limits, Neighbourhood};
use super::original::{OriginalSurface, outer};
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

/// Cost of moving one vertex.
struct MoveCost<'s> {
    surface: &'s OriginalSurface,
    vertex: usize,
    /// Quadratic and linear term of the squared distances to planes, given the neighbours.
    square: DMat3,
    pull: DVec3,
    /// Penalty for the squared distance beyond the limit.
    penalty: f64,
    limit: f64,
    /// True if no candidate cell can flip a face.
    is_safe: bool,
}

/// Cost of a cell: the number of flipped faces, then the error.
type Cost = (usize, f64);

/// Penalty factor beyond the limit: such a cell is a last resort.
const PENALTY: f64 = 100.0;

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

    /// Assigns each vertex to its closest cell, then in several passes to the neighbouring cell
    /// with the least cost.
    pub(super) fn assign(
        &mut self,
        surface: &OriginalSurface,
        grids: &[BlockGrid],
        options: &AssignOptions,
        vertices: impl Iterator<Item = usize> + Clone,
    ) {
        for v in vertices.clone() {
            let (grid, place) = (&grids[v / BLOCK], surface.places[v]);
            let at = grid.at(place);
            self.cells[v] = [0, 1, 2].map(|k| grid.within(k, at[k].round()));
            self.moved[v] = grid.place(self.cells[v]) - place;
        }
        for v in (0..options.sweeps).flat_map(|_| vertices.clone()) {
            self.assign_one(surface, &grids[v / BLOCK], v, options);
        }
    }

    fn assign_one(
        &mut self,
        surface: &OriginalSurface,
        grid: &BlockGrid,
        v: usize,
        options: &AssignOptions,
    ) {
        let judge = MoveCost::new(surface, grid, v, &self.moved, options);
        let place = surface.places[v];
        let at = grid.at(place);
        let mut best = (judge.cost(self.moved[v], &self.moved), self.cells[v], self.moved[v]);
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
                    if best.0.0 > 0 || judge.effect(moved) < best.0.1 {
                        let cost = judge.cost(moved, &self.moved);
                        if cost < best.0 {
                            best = (cost, [a, b, c], moved);
                        }
                    }
                }
            }
        }
        (self.cells[v], self.moved[v]) = (best.1, best.2);
    }

    /// Moves vertices that are farther than `most` from the surface to better cells. Returns those
    /// that stay too far.
    pub(super) fn repair(
        &mut self,
        surface: &OriginalSurface,
        grids: &[BlockGrid],
        most: f64,
        vertices: &[usize],
    ) -> Vec<usize> {
        let limits = Limits { enough: most, most: f64::INFINITY };
        let deviation = |moved: &[DVec3], hood: &Neighbourhood| hood.deviation(moved, limits);
        let is_far = |&v: &usize| {
            !surface.is_near(v, &self.moved, most)
                && deviation(&self.moved, &Neighbourhood::new(surface, v)) > most
        };
        let far: Vec<usize> = vertices.par_iter().copied().filter(is_far).collect();
        // One that is moved changes the faces of those around it.
        let mut far = surface.with_neighbours(far.into_iter());
        far.retain(|&v| {
            if surface.is_near(v, &self.moved, most) {
                return false;
            }
            let hood = Neighbourhood::new(surface, v);
            let is = deviation(&self.moved, &hood);
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

impl<'s> MoveCost<'s> {
    fn new(
        surface: &'s OriginalSurface,
        grid: &BlockGrid,
        vertex: usize,
        moved: &[DVec3],
        options: &AssignOptions,
    ) -> Self {
        let (mut square, mut pull, mut area) = (DMat3::ZERO, DVec3::ZERO, 0.0);
        let mut height = f64::INFINITY;
        for face in surface.faces_around(vertex) {
            // The mean square over a face is (a² + b² + c² + (a + b + c)²) / 12 of its corners'
            // distances.
            let others = face.corners.iter().filter(|&&corner| corner as usize != vertex);
            let distances = others.map(|&other| face.normal.dot(moved[other as usize]));
            square += outer(face.normal) * face.area;
            pull += face.normal * (face.area * 0.5 * distances.sum::<f64>());
            area += face.area;
            height = height.min(face.height);
        }
        let boundary = surface.boundary(vertex);
        square += DMat3::from_diagonal(DVec3::splat(area * options.along));
        square += boundary.map_or(DMat3::ZERO, |boundary| *boundary * area);
        let cell: f64 = grid.sides.iter().map(|side| side.length()).sum();
        let is_safe = height > 4.0 * cell;
        let penalty = PENALTY * area;
        Self { surface, vertex, square, pull, penalty, limit: options.limit, is_safe }
    }

    /// Returns the change of the summed squares for a displacement.
    fn effect(&self, moved: DVec3) -> f64 {
        moved.dot(self.square * moved + self.pull * 2.0)
    }

    fn cost(&self, moved: DVec3, all: &[DVec3]) -> Cost {
        let flips = if self.is_safe { 0 } else { self.flips(moved, all) };
        let mut effect = self.effect(moved);
        if moved.length_squared() > self.limit * self.limit {
            let over = (self.surface.plane_distance(self.vertex, moved) - self.limit).max(0.0);
            effect += self.penalty * over * over;
        }
        (flips, effect)
    }

    fn flips(&self, moved: DVec3, all: &[DVec3]) -> usize {
        let place = |v: u32| {
            let by = if v as usize == self.vertex { moved } else { all[v as usize] };
            self.surface.places[v as usize] + by
        };
        self.surface
            .faces_around(self.vertex)
            .filter(|face| face.is_flipped(face.corners.map(place)))
            .count()
    }

    /// Returns the best multiple of `side` to add; `None` if it makes no difference.
    fn best_along(&self, side: DVec3, moved: DVec3) -> Option<f64> {
        let bend = self.square * side;
        let times = -(bend.dot(moved) + side.dot(self.pull)) / bend.dot(side);
        times.is_finite().then_some(times)
    }
}

/// Returns the number of flipped faces around a vertex.
fn flips(surface: &OriginalSurface, v: usize, moved: &[DVec3]) -> usize {
    surface.faces_around(v).filter(|face| surface.is_flipped(face, moved)).count()
}
