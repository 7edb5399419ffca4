//! Strips that would begin with an odd triangle, made to begin with an even one.

use crate::anneal::{Annealing, Starts};
use crate::cover::Cover;
use crate::energy::Prices;

/// How often the odd strips are looked for. Of 150 on the bunny 115 stay, and 112 with four times the moves.
const PASSES: u64 = 8;

/// How many changes are tried for each end of an odd strip, each time.
const MOVES: f64 = 100.0;

/// Less than a swap, which would only be another vertex.
const ODD_END: f64 = 0.75;

/// Nothing may be lost.
const HEAT: f64 = 0.01;

impl Cover {
    /// Changes the strips that can start at neither end without doubling a vertex, where that costs nothing else.
    ///
    /// While a cover is annealed an odd end has a price of its own, for what the other end is like is not known there.
    /// Here the odd ends are those that do cost a vertex.
    pub(crate) fn even_out(&mut self, prices: &Prices, seed: u64) {
        for pass in 0..PASSES {
            let ends = self.odd_ends();
            let annealing = Annealing {
                prices: Prices { odd_end: ODD_END, ..*prices },
                heat: [HEAT, HEAT],
                moves_per_cell: MOVES,
                seed: seed ^ pass,
            };
            self.anneal(Starts::Cells(&ends), &annealing);
        }
    }

    /// The ends of paths whose both ends are odd.
    fn odd_ends(&self) -> Vec<u32> {
        let mut ends = Vec::new();
        for cell in (0..self.cells.len()).filter(|&cell| self.is_end(cell) && self.starts_odd(cell))
        {
            let far = self.path(cell).last().map_or(cell, |(far, _)| far);
            if self.starts_odd(far) {
                ends.push(cell as u32);
            }
        }
        ends
    }
}
