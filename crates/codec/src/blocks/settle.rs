//! Which cell each vertex takes: not always the one it is in.
//!
//! Where the surface is bent, a vertex that moves along its block leaves its own faces, and cells beside its own
//! leave them by more or by less: the one is taken that leaves them by the least, together with what the
//! neighbours do. Each vertex has its turn, with the others as they are [Bes86].

use glam::{DMat3, DVec3};

use super::surface::{Surface, outer};
use crate::kd::BLOCK;

/// The cells of a block.
pub(super) struct Grid {
    pub(super) sides: [DVec3; 3],
    /// The middle of the first.
    pub(super) first: DVec3,
    /// How many there are along each axis.
    pub(super) counts: [i32; 3],
}

/// Where vertices are put.
pub(super) struct Settled {
    pub(super) cells: Vec<[i32; 3]>,
    /// From where they were.
    pub(super) moved: Vec<DVec3>,
}

/// What settling heeds.
pub(super) struct Settling {
    /// How much moving along the surface counts, beside moving across it.
    pub(super) along: f64,
    /// How far a vertex may be from the planes of its faces, before that is dear.
    pub(super) limit: f64,
    /// How often each vertex has its turn.
    pub(super) sweeps: usize,
}

/// How moving a vertex is judged.
struct Judge<'s> {
    surface: &'s Surface,
    vertex: usize,
    /// The squares of distances to planes, and what neighbours do to them.
    square: DMat3,
    pull: DVec3,
    /// What a square beyond the limit costs.
    dear: f64,
    limit: f64,
    /// No cell that is tried can turn a face over.
    is_safe: bool,
}

/// What a cell costs: first how many faces are turned over.
type Cost = (usize, f64);

/// Beyond the limit a vertex stays only where there is nothing else.
const DEAR: f64 = 100.0;

impl Grid {
    /// The cells around a place, with parts.
    fn at(&self, place: DVec3) -> [f64; 3] {
        let away = place - self.first;
        self.sides.map(|side| away.dot(side) / side.length_squared())
    }

    fn place(&self, cell: [i32; 3]) -> DVec3 {
        let [u, v, w] = cell.map(f64::from);
        self.first + self.sides[0] * u + self.sides[1] * v + self.sides[2] * w
    }

    /// The closest number there is along an axis.
    fn within(&self, axis: usize, x: f64) -> i32 {
        (x as i32).clamp(0, self.counts[axis] - 1)
    }
}

impl Settled {
    /// Nowhere yet.
    pub(super) fn new(surface: &Surface) -> Self {
        let count = surface.places.len();
        Self { cells: vec![[0; 3]; count], moved: vec![DVec3::ZERO; count] }
    }

    /// Puts each vertex into the cell it is in, then into the one of those around that which is best for its faces,
    /// as far as its neighbours let them.
    pub(super) fn settle(
        &mut self,
        surface: &Surface,
        grids: &[Grid],
        options: &Settling,
        vertices: impl Iterator<Item = usize> + Clone,
    ) {
        for v in vertices.clone() {
            let (grid, place) = (&grids[v / BLOCK], surface.places[v]);
            let at = grid.at(place);
            self.cells[v] = [0, 1, 2].map(|k| grid.within(k, at[k].round()));
            self.moved[v] = grid.place(self.cells[v]) - place;
        }
        for v in (0..options.sweeps).flat_map(|_| vertices.clone()) {
            self.settle_one(surface, &grids[v / BLOCK], v, options);
        }
    }

    fn settle_one(&mut self, surface: &Surface, grid: &Grid, v: usize, options: &Settling) {
        let judge = Judge::new(surface, grid, v, &self.moved, options);
        let place = surface.places[v];
        let at = grid.at(place);
        let mut best = (judge.cost(self.moved[v], &self.moved), self.cells[v], self.moved[v]);
        // Faces that are turned over are worth looking farther.
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

    /// Puts vertices that are farther than `most` from the surface where they are least so; which stay too far.
    pub(super) fn mend(
        &mut self,
        surface: &Surface,
        grids: &[Grid],
        most: f64,
        vertices: impl Iterator<Item = usize>,
    ) -> Vec<usize> {
        let stays_far = |&v: &usize| {
            !surface.is_near(v, &self.moved, most)
                && surface.apart(v, &self.moved, most) > most
                && self.mend_one(surface, &grids[v / BLOCK], v, most) > most
        };
        vertices.filter(stays_far).collect()
    }

    fn mend_one(&mut self, surface: &Surface, grid: &Grid, v: usize, most: f64) -> f64 {
        let at = grid.at(surface.places[v]);
        // The closest first: any that is near enough will do.
        let range = |k: usize| [0.0, 1.0, -1.0, 2.0].map(|by| grid.within(k, at[k].floor() + by));
        let cost = |moved: &[DVec3]| (flips(surface, v, moved), surface.apart(v, moved, most));
        let mut best = (cost(&self.moved), self.cells[v], self.moved[v]);
        let [across, along, beside] = [2, 1, 0].map(range);
        let cells = across.iter().flat_map(|&c| along.iter().map(move |&b| (b, c)));
        for cell in cells.flat_map(|(b, c)| beside.iter().map(move |&a| [a, b, c])) {
            self.moved[v] = grid.place(cell) - surface.places[v];
            let cost = cost(&self.moved);
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

impl<'s> Judge<'s> {
    fn new(
        surface: &'s Surface,
        grid: &Grid,
        vertex: usize,
        moved: &[DVec3],
        options: &Settling,
    ) -> Self {
        let (mut square, mut pull, mut area) = (DMat3::ZERO, DVec3::ZERO, 0.0);
        let mut height = f64::INFINITY;
        for face in surface.around(vertex) {
            // The mean square over a face is (a² + b² + c² + (a + b + c)²) / 12 of its corners' distances.
            let others = face.corners.iter().filter(|&&corner| corner as usize != vertex);
            let distances = others.map(|&other| face.normal.dot(moved[other as usize]));
            square += outer(face.normal) * face.area;
            pull += face.normal * (face.area * 0.5 * distances.sum::<f64>());
            area += face.area;
            height = height.min(face.height);
        }
        let rim = surface.rim(vertex);
        square += DMat3::from_diagonal(DVec3::splat(area * options.along));
        square += rim.map_or(DMat3::ZERO, |rim| *rim * area);
        let cell: f64 = grid.sides.iter().map(|side| side.length()).sum();
        let is_safe = height > 4.0 * cell;
        let dear = DEAR * area;
        Self { surface, vertex, square, pull, dear, limit: options.limit, is_safe }
    }

    /// What moving by so much does to the mean square.
    fn effect(&self, moved: DVec3) -> f64 {
        moved.dot(self.square * moved + self.pull * 2.0)
    }

    fn cost(&self, moved: DVec3, all: &[DVec3]) -> Cost {
        let flips = if self.is_safe { 0 } else { self.flips(moved, all) };
        let mut effect = self.effect(moved);
        if moved.length_squared() > self.limit * self.limit {
            let over = (self.surface.leaves(self.vertex, moved) - self.limit).max(0.0);
            effect += self.dear * over * over;
        }
        (flips, effect)
    }

    fn flips(&self, moved: DVec3, all: &[DVec3]) -> usize {
        let place = |v: u32| {
            let by = if v as usize == self.vertex { moved } else { all[v as usize] };
            self.surface.places[v as usize] + by
        };
        self.surface
            .around(self.vertex)
            .filter(|face| face.is_flipped(face.corners.map(place)))
            .count()
    }

    /// How many times `side` is best added; `None` where it makes no difference.
    fn best_along(&self, side: DVec3, moved: DVec3) -> Option<f64> {
        let bend = self.square * side;
        let times = -(bend.dot(moved) + side.dot(self.pull)) / bend.dot(side);
        times.is_finite().then_some(times)
    }
}

/// How many faces around a vertex are turned over.
fn flips(surface: &Surface, v: usize, moved: &[DVec3]) -> usize {
    surface.around(v).filter(|face| surface.is_flipped(face, moved)).count()
}
