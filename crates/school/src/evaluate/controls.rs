//! Control policies, the baseline of the evaluation.

use meshlod::flock::levels::{LevelTable, NEAREST_FACING};
use meshlod::flock::select::policies::{
    Along, RelativeTo, SHELLS, ScreenError, SidedLevels, each_school,
};
use meshlod::flock::select::{ChainLevels, InstanceLevel, Policy, View};

/// Gives every member a level at random, the same in all frames.
pub(super) struct RandomLevels {
    levels: ChainLevels,
}

/// Paper's policy, except that every member takes the layer of another one.
pub(super) struct ShuffledLayer {
    chains: SidedLevels,
}

/// Levels by their error in pixels, from the facing chains.
pub(super) struct ScreenErrorFacing {
    whole: ScreenError,
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
        each_school(view, levels, self.chains.whole(), |school, levels| {
            let by_distance = self.chains.of(view, school);
            let distance = RelativeTo::new(view, school, Along::Leader);
            let (to_ball, range) = (school.to_unit_ball(), school.members.clone());
            view.assign_range(range.clone(), levels, |first, lanes, chosen| {
                let squares = distance.squares(lanes);
                for (lane, level) in chosen.iter_mut().enumerate().take(range.end - first) {
                    // Half the school away, which is another place in the ellipsoid.
                    let other =
                        range.start + (first + lane - range.start + range.len() / 2) % range.len();
                    let place = to_ball * (view.flock.members.position(other) - school.leader);
                    let shell = ((4.0 * place.length()) as usize).min(4);
                    *level = by_distance.at_squared(squares[lane] * SHELLS[shell].powi(2));
                }
            });
        });
    }
}

impl ScreenErrorFacing {
    pub(super) fn new(table: &LevelTable) -> Self {
        Self { whole: ScreenError::new(table) }
    }
}

impl Policy for ScreenErrorFacing {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        self.whole.select(view, levels);
        for (member, level) in levels.iter_mut().enumerate() {
            let Some(depth) = level.level() else { continue };
            let members = &view.flock.members;
            let to_eye = view.camera.eye() - members.position(member);
            if to_eye.length() > NEAREST_FACING {
                let direction = members.frame(member).transpose() * to_eye;
                *level = InstanceLevel::drawn(view.table.facing_level(depth, direction));
            }
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
