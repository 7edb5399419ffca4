//! Sharing out of a budget of triangles among cells of members that are alike.

use crate::select::policies::picture_gain::gains::{Gains, Step};
use crate::select::policies::picture_gain::visibility::{VISIBILITIES, log_visibility};

/// Number of members in each cell, and the levels chosen for them.
pub(super) struct Allocation {
    counts: Vec<u32>,
    choices: Vec<CellLevels>,
    /// Cells with members.
    occupied: Vec<u32>,
    /// Triangles that steps of each gain would add, by the logarithm of the gain.
    wanted: Vec<u64>,
}

/// Depths of the levels for the members of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct CellLevels {
    pub best: u8,
    /// Finest and coarsest that a member may keep.
    pub finest: u8,
    pub coarsest: u8,
}

/// Buckets of the logarithm of a gain to the octave.
const BUCKETS: f32 = 32.0;

/// Octaves of gain above and below one that have buckets.
const OCTAVES: f32 = 32.0;

/// Octaves of gain by which a level may be off before a member leaves it.
const BAND: f32 = 0.5;

impl Allocation {
    pub(super) fn new(cells: usize) -> Self {
        Self {
            counts: vec![0; cells],
            choices: vec![CellLevels::default(); cells],
            occupied: Vec::with_capacity(cells),
            wanted: vec![0; (2.0 * OCTAVES * BUCKETS) as usize + 1],
        }
    }

    pub(super) fn clear(&mut self) {
        for cell in self.occupied.drain(..) {
            self.counts[cell as usize] = 0;
        }
    }

    /// Adds a member to a cell.
    #[inline]
    pub(super) fn count(&mut self, cell: usize) {
        if self.counts[cell] == 0 {
            self.occupied.push(cell as u32);
        }
        self.counts[cell] += 1;
    }

    #[inline]
    pub(super) fn choice(&self, cell: usize) -> CellLevels {
        self.choices[cell]
    }

    /// Chooses the levels of all cells: takes the steps of greatest gain while the budget lasts.
    pub(super) fn share_out(&mut self, gains: &Gains, budget: usize) {
        let Self { counts, choices, occupied, wanted, .. } = self;
        wanted.fill(0);
        let mut spent = 0u64;
        for &cell in occupied.iter() {
            let (look, visibility) = (cell as usize / VISIBILITIES, cell as usize % VISIBILITIES);
            let count = u64::from(counts[cell as usize]);
            spent += count * u64::from(gains.coarsest(look).1);
            for step in gains.steps(look) {
                wanted[bucket(step, visibility)] += count * u64::from(step.triangles);
            }
        }
        // Whole buckets are taken, so that like members are treated alike.
        let mut least = wanted.len();
        while least > 0 && spent + wanted[least - 1] <= budget as u64 {
            least -= 1;
            spent += wanted[least];
        }
        let band = (BAND * BUCKETS) as usize;
        for &cell in occupied.iter() {
            let (look, visibility) = (cell as usize / VISIBILITIES, cell as usize % VISIBILITIES);
            let depth = |least: usize| {
                let worth = |step: &&Step| bucket(step, visibility) >= least;
                let last = gains.steps(look).iter().take_while(worth).last();
                last.map_or(gains.coarsest(look).0, |step| step.depth)
            };
            choices[cell as usize] = CellLevels {
                best: depth(least),
                finest: depth(least.saturating_sub(band)),
                coarsest: depth(least + band),
            };
        }
    }
}

/// Returns the bucket of a step's gain for members of this visibility.
#[inline]
fn bucket(step: &Step, visibility: usize) -> usize {
    let log = step.log_gain + log_visibility(visibility);
    ((log.clamp(-OCTAVES, OCTAVES) + OCTAVES) * BUCKETS) as usize
}
