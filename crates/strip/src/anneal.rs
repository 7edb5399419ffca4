//! Simulated annealing of a path cover by tunnelling moves.

use rayon::prelude::*;

use crate::dual_node::{DualEdge, DualNode};
use crate::energy::{Energy, Prices, UNIT};
use crate::path_cover::PathCover;
use crate::random::Random;
use crate::region::Region;

/// Annealing schedule and prices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Annealing {
    pub(crate) prices: Prices,
    /// Mean cost a move may add, in vertices: at the first moves and at the last.
    pub(crate) heat: [f64; 2],
    /// Number of moves per node they may start from.
    pub(crate) moves_per_node: f64,
    pub(crate) seed: u64,
}

/// Nodes that moves start from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Starts<'a> {
    /// All nodes, in runs of this length that are annealed in parallel. Neighbouring faces should
    /// be close in the cover, because a node with a neighbour in another run is frozen until a
    /// round with other runs.
    Runs(usize),
    /// Only these nodes, though a move may go on to others.
    Nodes(&'a [u32]),
}

/// Number of cooling steps, after each of which ends and swaps are collected anew. The bunny, 60
/// moves per node: 1.110 vertices per face with 25, 1.109 with 50, 1.106 with 100 and 200.
const ROUNDS: usize = 100;

/// Share of the moves, in 256ths, that start at the end of a strip or at a swap. The bunny, 60
/// moves per node: 1.109 with half, 1.108 with .7, 1.105 with .9 and with all, but with all, strips
/// grow crooked where none ends.
const AT_DEFECTS: usize = 218;

impl PathCover {
    /// Tries moves and keeps those within the limit of the current temperature.
    ///
    /// Deterministic for any number of threads. Cost: O(starts · moves), plus the walks along the
    /// changed paths.
    pub(crate) fn anneal(&mut self, starts: Starts, annealing: &Annealing) {
        let energy = Energy::new(&annealing.prices);
        let limits = Limits::new();
        let mut due = Due { each: annealing.moves_per_node / ROUNDS as f64, left: 0.0 };
        for number in 0..ROUNDS {
            let heat = annealing.heat_after((number + 1) as f64 / ROUNDS as f64);
            let round = Round { energy: &energy, limits: &limits, heat };
            let random = Random::new(annealing.seed, number as u64);
            match starts {
                Starts::Runs(run) => round.runs(&mut self.nodes, run, due.each, random),
                Starts::Nodes(nodes) => {
                    let region =
                        Region::new(&mut self.nodes, 0, &energy).touching(self.touched.as_mut());
                    round.anneal(region, nodes, due.of(nodes.len()), random);
                }
            }
        }
    }
}

impl Annealing {
    /// Returns the temperature after a part of the rounds. It stays high for long and falls late:
    /// strips that run side by side merge while it is hot, and lose their swaps as it cools.
    /// fandisk.off, 1500 moves per node, from .7 to .12: 1.070 vertices per face with the cube of
    /// the part, 1.074 with its square, 1.077 with the part itself.
    fn heat_after(&self, part: f64) -> f64 {
        let [hot, cold] = self.heat;
        hot * (cold / hot).powf(part.powi(3))
    }
}

/// Number of moves per round, carrying fractions over to the next.
struct Due {
    each: f64,
    left: f64,
}

impl Due {
    /// Returns the moves of a round that starts from `count` nodes.
    fn of(&mut self, count: usize) -> usize {
        self.left += self.each * count as f64;
        let moves = self.left.floor();
        self.left -= moves;
        moves as usize
    }
}

/// Equally likely limits on the cost of a move at temperature one.
#[derive(Clone, Debug)]
pub(crate) struct Limits([f64; 256]);

impl Limits {
    pub(crate) fn new() -> Self {
        Self(std::array::from_fn(|i| -((i as f64 + 0.5) / 256.0).ln() * UNIT))
    }

    /// Draws a limit on the cost of one move.
    #[inline]
    pub(crate) fn draw(&self, heat: f64, random: &mut Random) -> i32 {
        (heat * self.0[random.below(256)]) as i32
    }
}

/// A round of moves at one temperature.
#[derive(Clone, Copy)]
struct Round<'a> {
    energy: &'a Energy,
    limits: &'a Limits,
    heat: f64,
}

impl Round<'_> {
    /// Anneals runs of nodes in parallel. The first begins at a random node, so that borders move
    /// between rounds.
    fn runs(self, nodes: &mut [DualNode], run: usize, moves_per_node: f64, mut random: Random) {
        let first = if nodes.len() > run { random.below(run) } else { 0 };
        let seed = random.bits();
        let (head, rest) = nodes.split_at_mut(first);
        let others =
            rest.par_chunks_mut(run).enumerate().map(|(i, run_of)| (first + i * run, run_of));
        rayon::iter::once((0, head)).chain(others).for_each(|(first, nodes)| {
            freeze_border(nodes, first);
            let starts: Vec<u32> = (0..nodes.len())
                .filter(|&c| !nodes[c].frozen)
                .map(|c| (first + c) as u32)
                .collect();
            let moves = (moves_per_node * nodes.len() as f64).round() as usize;
            let region = Region::new(nodes, first, self.energy);
            self.anneal(region, &starts, moves, Random::new(seed, first as u64));
        });
    }

    /// Tries `moves` moves, most of them at ends and swaps.
    fn anneal(self, mut region: Region, starts: &[u32], moves: usize, mut random: Random) {
        let is_defect = |node: &u32| region.is_defect(*node as usize);
        let mut defects: Vec<u32> = starts.iter().copied().filter(is_defect).collect();
        if defects.is_empty() {
            return;
        }
        let mut at = 0;
        for _ in 0..moves {
            let limit = self.limits.draw(self.heat, &mut random);
            if random.below(256) >= AT_DEFECTS {
                region.try_tunnel(starts[random.below(starts.len())] as usize, limit, &mut random);
                continue;
            }
            // The next move may go on from where this one ended.
            if let Some(to) = region.try_tunnel(defects[at] as usize, limit, &mut random) {
                defects[at] = to as u32;
            }
            at = if at + 1 == defects.len() { 0 } else { at + 1 };
        }
    }
}

/// Freezes exactly those nodes of a run that have neighbours outside it.
fn freeze_border(nodes: &mut [DualNode], first: usize) {
    let inside = first..first + nodes.len();
    let leaves = |edge: &DualEdge| !edge.is_none() && !inside.contains(&edge.node());
    for node in nodes {
        node.frozen = node.across.iter().any(leaves);
    }
}
