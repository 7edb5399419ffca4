//! Policies that know nothing, against which the others are held.

use crate::levels::LevelTable;
use crate::select::policies::{Along, RelativeTo, SHELLS, SidedLevels};
use crate::select::{ChainLevels, InstanceLevel, Policy, View};

/// Gives every member a level at random, the same in all frames.
pub(super) struct RandomLevels {
    levels: ChainLevels,
}

/// Paper's policy with the layer of another member in place of its own.
pub(super) struct ShuffledLayer {
    chains: SidedLevels,
}

/// Octaves over which random levels are spread.
const SPREAD: f32 = 6.0;

impl RandomLevels {
    pub(super) fn new(_table: &LevelTable) -> Self {
        Self { levels: ChainLevels::new() }
    }
}

impl Policy for RandomLevels {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        let share = view.detail() / 16.0;
        self.levels.fill_by_share(view.table, &view.table.chains[0], |distance| share / distance);
        let by_distance = &self.levels;
        view.assign(levels, |first, _, chosen| {
            for (lane, level) in chosen.iter_mut().enumerate() {
                let distance = (SPREAD * (random(first + lane) - 0.5)).exp2();
                *level = by_distance.at_squared(distance * distance);
            }
        });
    }
}

impl ShuffledLayer {
    pub(super) fn new(_table: &LevelTable) -> Self {
        Self { chains: SidedLevels::default() }
    }
}

impl Policy for ShuffledLayer {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        self.chains.fill(view);
        for school in &view.flock.schools {
            let by_distance = self.chains.of(view, school);
            let distance = RelativeTo::new(view, school, Along::Leader);
            view.assign_range(school.members.clone(), levels, |first, lanes, chosen| {
                let squares = distance.squares(lanes);
                for (lane, level) in chosen.iter_mut().enumerate() {
                    // Radius of a point strewn at random in a ball.
                    let radius = random(first + lane).cbrt();
                    let factor = SHELLS[(4.0 * radius) as usize];
                    *level = by_distance.at_squared(squares[lane] * factor * factor);
                }
            });
        }
    }
}

/// Returns a number from 0 to below 1 for a member.
fn random(member: usize) -> f32 {
    // SplitMix64 [SLF14].
    let mut z = (member as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
}
