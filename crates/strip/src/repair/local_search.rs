//! Local search for better triangle strips around given nodes.

use crate::anneal::{Annealing, Limits, Starts};
use crate::energy::{Energy, Prices};
use crate::path_cover::PathCover;
use crate::random::Random;
use crate::region::Region;

/// Effort spent on repairing triangle strips after a change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum StripEffort {
    /// Quick repair, fast enough for a level of detail that changes every frame.
    Quick,
    /// Thorough repair, for levels of detail that are made once.
    #[default]
    Thorough,
}

/// Temperatures of a quick repair, in vertices, one per pass; each pass tries one move at every
/// defect.
///
/// The horse from all faces to a tenth and back in steps of a hundredth, mean vertices per triangle
/// and µs per changed triangle: 1.327 in .7 with 0, 0; 1.300 in 1.0 with .3, .1, 0; 1.283 in 1.2
/// with these; 1.267 in 2 with .2, .2, .1, .1, 0, 0.
const QUICK_HEATS: [f64; 4] = [0.2, 0.1, 0.05, 0.0];

/// First and last temperature of a thorough repair, and its moves per triangle. Good strips must
/// not be melted: whole meshes are annealed from .9.
const THOROUGH_HEATS: [f64; 2] = [0.35, 0.08];
const THOROUGH_MOVES: f64 = 100.0;

/// Smallest number of moves of a thorough repair, some milliseconds. With 100 moves for each of 48
/// triangles the result varies between 1.29 and 1.25 vertices per triangle.
const THOROUGH_LEAST_MOVES: f64 = 50_000.0;

/// Improves a cover by random moves from given nodes.
#[derive(Clone, Debug)]
pub(super) struct LocalSearch {
    effort: StripEffort,
    prices: Prices,
    energy: Energy,
    limits: Limits,
    random: Random,
}

impl LocalSearch {
    pub(super) fn new(effort: StripEffort) -> Self {
        let prices = Prices::default();
        Self {
            effort,
            prices,
            energy: Energy::new(&prices),
            limits: Limits::new(),
            random: Random::new(0, 0),
        }
    }

    /// Tries moves from the given nodes, which may go on to others.
    pub(super) fn improve(&mut self, cover: &mut PathCover, nodes: &[u32]) {
        match self.effort {
            StripEffort::Quick => self.quench(cover, nodes),
            StripEffort::Thorough => cover.anneal(
                Starts::Nodes(nodes),
                &Annealing {
                    prices: self.prices,
                    heat: THOROUGH_HEATS,
                    moves_per_node: THOROUGH_MOVES
                        .max(THOROUGH_LEAST_MOVES / nodes.len().max(1) as f64),
                    seed: self.random.bits(),
                },
            ),
        }
    }

    fn quench(&mut self, cover: &mut PathCover, nodes: &[u32]) {
        let Self { energy, limits, random, .. } = self;
        let PathCover { nodes: all, touched } = cover;
        let mut region = Region::new(all, 0, energy).touching(touched.as_mut());
        for heat in QUICK_HEATS {
            for &node in nodes {
                if region.is_defect(node as usize) {
                    let limit = limits.draw(heat, random);
                    region.try_tunnel(node as usize, limit, random);
                }
            }
        }
    }
}
