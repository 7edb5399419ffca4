//! A cover made better by many small changes, fewer and fewer of which may cost anything.

use rayon::prelude::*;

use crate::cover::{Cell, Cover, Port};
use crate::energy::{Energy, Prices, UNIT};
use crate::random::Random;
use crate::region::Region;

/// How a cover is annealed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Annealing {
    pub(crate) prices: Prices,
    /// What a change may cost, on average, in vertices: with the first moves, and with the last.
    pub(crate) heat: [f64; 2],
    /// How many changes are tried for each cell they may start from.
    pub(crate) moves_per_cell: f64,
    pub(crate) seed: u64,
}

/// The cells that changes start from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Starts<'a> {
    /// All, and runs of so many cells are changed at the same time. Cells that lie side by side should be near each
    /// other in the cover, for those with a neighbour in another run wait for a round that has other runs.
    Runs(usize),
    /// Only these; but a change goes on to others.
    Cells(&'a [u32]),
}

/// How often the heat falls, and ends and swaps are looked for anew. The bunny, 60 moves a cell: 25 rounds leave 1.110
/// vertices a face, 50 1.109, 100 and 200 1.106.
const ROUNDS: usize = 100;

/// How many of 256 changes start where a strip ends or swaps. The bunny, 60 moves a cell: half 1.109, .7 1.108, .9
/// 1.105, all 1.105, but then strips grow crooked where none ends.
const AT_DEFECTS: usize = 218;

impl Cover {
    /// Tries changes, and keeps those that do not cost too much.
    ///
    /// The same cover, starts and annealing give the same result, for any number of threads. Cost: O(starts · moves),
    /// and what it takes to walk the paths that change.
    pub(crate) fn anneal(&mut self, starts: Starts, annealing: &Annealing) {
        let energy = Energy::new(&annealing.prices);
        let limits = Limits::new();
        let mut due = Due { each: annealing.moves_per_cell / ROUNDS as f64, left: 0.0 };
        for number in 0..ROUNDS {
            let heat = annealing.heat_after((number + 1) as f64 / ROUNDS as f64);
            let round = Round { energy: &energy, limits: &limits, heat };
            let random = Random::new(annealing.seed, number as u64);
            match starts {
                Starts::Runs(run) => round.runs(&mut self.cells, run, due.each, random),
                Starts::Cells(cells) => {
                    let region = Region::new(&mut self.cells, 0, &energy);
                    round.anneal(region, cells, due.of(cells.len()), random);
                }
            }
        }
    }
}

impl Annealing {
    /// The heat after a part of the rounds. It is high for long and falls late: strips that run side by side grow
    /// together where it is hot, and take their swaps away while it cools. fandisk.off, 1500 moves a cell, from .7 to
    /// .12: 1.070 vertices a face with the cube of the part, 1.074 with its square, 1.077 with the part itself.
    fn heat_after(&self, part: f64) -> f64 {
        let [hot, cold] = self.heat;
        hot * (cold / hot).powf(part.powi(3))
    }
}

/// How many moves there are to do: parts of one add up.
struct Due {
    each: f64,
    left: f64,
}

impl Due {
    /// The moves of one round that starts from `count` cells.
    fn of(&mut self, count: usize) -> usize {
        self.left += self.each * count as f64;
        let moves = self.left.floor();
        self.left -= moves;
        moves as usize
    }
}

/// What changes may cost at a heat of one, each as likely as the others.
#[derive(Clone, Debug)]
pub(crate) struct Limits([f64; 256]);

impl Limits {
    pub(crate) fn new() -> Self {
        Self(std::array::from_fn(|i| -((i as f64 + 0.5) / 256.0).ln() * UNIT))
    }

    /// What one change may cost.
    #[inline]
    pub(crate) fn draw(&self, heat: f64, random: &mut Random) -> i32 {
        (heat * self.0[random.below(256)]) as i32
    }
}

/// Changes at one heat.
#[derive(Clone, Copy)]
struct Round<'a> {
    energy: &'a Energy,
    limits: &'a Limits,
    heat: f64,
}

impl Round<'_> {
    /// Anneals runs of cells side by side, beginning at a random cell, so that their borders are elsewhere next time.
    fn runs(self, cells: &mut [Cell], run: usize, moves_per_cell: f64, mut random: Random) {
        let first = if cells.len() > run { random.below(run) } else { 0 };
        let seed = random.bits();
        let (head, rest) = cells.split_at_mut(first);
        let others =
            rest.par_chunks_mut(run).enumerate().map(|(i, run_of)| (first + i * run, run_of));
        rayon::iter::once((0, head)).chain(others).for_each(|(first, cells)| {
            hold_border(cells, first);
            let starts: Vec<u32> =
                (0..cells.len()).filter(|&c| !cells[c].held).map(|c| (first + c) as u32).collect();
            let moves = (moves_per_cell * cells.len() as f64).round() as usize;
            let region = Region::new(cells, first, self.energy);
            self.anneal(region, &starts, moves, Random::new(seed, first as u64));
        });
    }

    /// Tries `moves` changes, most of them where a strip ends or swaps.
    fn anneal(self, mut region: Region, starts: &[u32], moves: usize, mut random: Random) {
        let is_defect = |cell: &u32| region.is_defect(*cell as usize);
        let mut defects: Vec<u32> = starts.iter().copied().filter(is_defect).collect();
        if defects.is_empty() {
            return;
        }
        let mut at = 0;
        for _ in 0..moves {
            let limit = self.limits.draw(self.heat, &mut random);
            if random.below(256) >= AT_DEFECTS {
                region.try_trail(starts[random.below(starts.len())] as usize, limit, &mut random);
                continue;
            }
            // Where a kept change comes to is where the next may go on.
            if let Some(to) = region.try_trail(defects[at] as usize, limit, &mut random) {
                defects[at] = to as u32;
            }
            at = if at + 1 == defects.len() { 0 } else { at + 1 };
        }
    }
}

/// Holds the cells of a run that have neighbours outside it, and no others.
fn hold_border(cells: &mut [Cell], first: usize) {
    let inside = first..first + cells.len();
    let leaves = |port: &Port| !port.is_none() && !inside.contains(&port.cell());
    for cell in cells {
        cell.held = cell.across.iter().any(leaves);
    }
}
