//! A cover made better by many small changes, fewer and fewer of which may cost anything.

use crate::cover::Cover;
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
    /// All.
    All,
    /// Only these; but a change goes on to others.
    Cells(&'a [u32]),
}

/// How often the heat falls, and the ends and swaps are looked for anew.
const ROUNDS: usize = 50;

impl Cover {
    /// Tries changes that start from some cells, and keeps those that do not cost too much.
    ///
    /// The same cover, seed and starts give the same result. Cost: O(cells to start from · moves), and what it takes
    /// to walk the paths that change.
    pub(crate) fn anneal(&mut self, starts: Starts, annealing: &Annealing) {
        let energy = Energy::new(&annealing.prices);
        let mut random = Random::new(annealing.seed, 0);
        let [hot, cold] = annealing.heat;
        let mut region = Region::new(&mut self.cells, 0, &energy);
        let mut spent = 0.0;
        for round in 0..ROUNDS {
            let part = (round + 1) as f64 / ROUNDS as f64;
            let due = annealing.moves_per_cell * starts.count(&region) as f64 * part;
            let limits = Limits::new(hot * (cold / hot).powf(part));
            spent += region.anneal(starts, (due - spent) as usize, &limits, &mut random) as f64;
        }
    }
}

impl Starts<'_> {
    fn count(self, region: &Region) -> usize {
        match self {
            Self::All => region.range().len(),
            Self::Cells(cells) => cells.len(),
        }
    }

    #[inline]
    fn get(self, region: &Region, i: usize) -> usize {
        match self {
            Self::All => region.range().start + i,
            Self::Cells(cells) => cells[i] as usize,
        }
    }
}

/// What each change may cost, at one heat.
struct Limits([i32; 256]);

impl Limits {
    fn new(heat: f64) -> Self {
        let limit = |i: usize| (-heat * ((i as f64 + 0.5) / 256.0).ln() * UNIT) as i32;
        Self(std::array::from_fn(limit))
    }

    #[inline]
    fn draw(&self, random: &mut Random) -> i32 {
        self.0[random.below(256)]
    }
}

impl Region<'_> {
    /// Tries `moves` changes at one heat, every second one where a strip ends or swaps. How many it tried.
    fn anneal(
        &mut self,
        starts: Starts,
        moves: usize,
        limits: &Limits,
        random: &mut Random,
    ) -> usize {
        let count = starts.count(self);
        let mut defects: Vec<usize> =
            (0..count).map(|i| starts.get(self, i)).filter(|&cell| self.is_defect(cell)).collect();
        if defects.is_empty() {
            return 0;
        }
        let mut at = 0;
        for _ in 0..moves / 2 {
            // Where a kept change comes to is where the next may go on.
            if let Some(to) = self.try_trail(defects[at], limits.draw(random), random) {
                defects[at] = to;
            }
            at = if at + 1 == defects.len() { 0 } else { at + 1 };
            let any = starts.get(self, random.below(count));
            self.try_trail(any, limits.draw(random), random);
        }
        moves / 2 * 2
    }
}
