//! Fixes the parity of triangle strips that would have to double their first vertex.

use crate::anneal::{Annealing, Starts};
use crate::energy::Prices;
use crate::path_cover::PathCover;

/// Number of passes over the odd strips. Of 150 on the bunny 115 remain, and 112 with four times
/// the moves.
const PASSES: u64 = 8;

/// Number of moves tried per end of an odd strip and pass.
const MOVES: f64 = 100.0;

/// Price of an odd end here: less than a swap, which costs a vertex too.
const ODD_END: f64 = 0.75;

/// Temperature: nothing may get worse.
const HEAT: f64 = 0.01;

impl PathCover {
    /// Changes strips that can start at neither end without doubling a vertex, where that costs
    /// nothing else.
    ///
    /// While a cover is annealed every odd end has a price, because the other end is not known
    /// there. Here only the odd ends that do cost a vertex count.
    pub(crate) fn fix_parity(&mut self, prices: &Prices, seed: u64) {
        for pass in 0..PASSES {
            let ends = self.odd_ends();
            let annealing = Annealing {
                prices: Prices { odd_end: ODD_END, ..*prices },
                heat: [HEAT, HEAT],
                moves_per_node: MOVES,
                seed: seed ^ pass,
            };
            self.anneal(Starts::Nodes(&ends), &annealing);
        }
    }

    /// Lists the ends of paths with two odd ends.
    fn odd_ends(&self) -> Vec<u32> {
        let mut ends = Vec::new();
        for node in (0..self.nodes.len()).filter(|&node| self.is_end(node) && self.starts_odd(node))
        {
            let far = self.path(node).last().map_or(node, |(far, _)| far);
            if self.starts_odd(far) {
                ends.push(node as u32);
            }
        }
        ends
    }
}
