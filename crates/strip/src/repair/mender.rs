//! The local changes of a repair.

use super::Effort;
use crate::anneal::{Annealing, Limits, Starts};
use crate::cover::Cover;
use crate::energy::{Energy, Prices};
use crate::random::Random;
use crate::region::Region;

/// What a change of a quick repair may cost on average, in vertices, pass by pass; each tries one at every defect.
///
/// The horse from all faces to a tenth and back by hundredths, the mean of vertices a triangle and µs a changed
/// triangle: 0, 0 gave 1.327 in .7; .3, .1, 0 1.300 in 1.0; these 1.283 in 1.2; .2, .2, .1, .1, 0, 0 1.267 in 2.
const QUICK_HEATS: [f64; 4] = [0.2, 0.1, 0.05, 0.0];

/// What a change of a thorough repair may cost with the first moves and with the last, and how many moves there are a
/// triangle. A seed must not be melted: whole meshes are annealed from .9.
const THOROUGH_HEATS: [f64; 2] = [0.35, 0.08];
const THOROUGH_MOVES: f64 = 100.0;

/// But so many in all at least, which are some milliseconds: of 48 triangles 100 each leave 1.29 vertices a triangle or
/// 1.25, as luck has it.
const THOROUGH_LEAST_MOVES: f64 = 50_000.0;

/// Changes a cover for the better, beginning where it is told to.
#[derive(Clone, Debug)]
pub(super) struct Mender {
    effort: Effort,
    prices: Prices,
    energy: Energy,
    limits: Limits,
    random: Random,
}

impl Mender {
    pub(super) fn new(effort: Effort) -> Self {
        let prices = Prices::default();
        Self {
            effort,
            prices,
            energy: Energy::new(&prices),
            limits: Limits::new(),
            random: Random::new(0, 0),
        }
    }

    /// Tries changes that start from some cells, which may go on to others.
    pub(super) fn mend(&mut self, cover: &mut Cover, cells: &[u32]) {
        match self.effort {
            Effort::Quick => self.quench(cover, cells),
            Effort::Thorough => cover.anneal(
                Starts::Cells(cells),
                &Annealing {
                    prices: self.prices,
                    heat: THOROUGH_HEATS,
                    moves_per_cell: THOROUGH_MOVES
                        .max(THOROUGH_LEAST_MOVES / cells.len().max(1) as f64),
                    seed: self.random.bits(),
                },
            ),
        }
    }

    fn quench(&mut self, cover: &mut Cover, cells: &[u32]) {
        let Self { energy, limits, random, .. } = self;
        let mut region = Region::new(&mut cover.cells, 0, energy);
        for heat in QUICK_HEATS {
            for &cell in cells {
                if region.is_defect(cell as usize) {
                    let limit = limits.draw(heat, random);
                    region.try_trail(cell as usize, limit, random);
                }
            }
        }
    }
}
