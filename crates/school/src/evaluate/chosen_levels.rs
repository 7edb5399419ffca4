//! Levels that an arm chooses with one bias, and their cost.

use std::ops::RangeInclusive;
use std::sync::Arc;
use std::time::Instant;

use meshlod::flock::levels::LevelTable;
use meshlod::flock::select::{Budget, InstanceLevel, Selector};

use crate::evaluate::arms::Arm;
use crate::evaluate::curve::mean;
use crate::footage::Footage;

/// Levels that an arm chose with one bias.
#[derive(Default)]
pub(super) struct ChosenLevels {
    /// Levels in both frames of each pair.
    pub levels: Vec<[Vec<InstanceLevel>; 2]>,
    /// Triangles of the scored frames.
    pub triangles: Vec<usize>,
    /// Changes of level, and the time for which members were in view.
    switches: usize,
    member_seconds: f64,
    /// Number of choices and their time.
    choices: usize,
    choice_seconds: f64,
}

/// Scored pair of consecutive frames, with the frames before it.
pub(super) struct FramePair<'a> {
    pub footage: &'a Footage,
    /// First frame of the pair.
    pub first: usize,
    /// Visible members in every frame of the run.
    pub visible: &'a [Vec<bool>],
}

/// Frames before a scored pair for which levels are chosen, so that hysteresis has its effect.
const RUN_UP: usize = 6;

/// Returns the first frame for which levels are chosen, given the first frame of a pair.
pub(super) fn run_start(first: usize) -> usize {
    first.saturating_sub(RUN_UP)
}

impl FramePair<'_> {
    /// Returns the frames for which levels are chosen.
    fn run(&self) -> RangeInclusive<usize> {
        run_start(self.first)..=(self.first + 1).min(self.footage.flocks.len() - 1)
    }
}

impl ChosenLevels {
    /// Runs an arm over a pair and the frames before it.
    pub fn add(
        &mut self,
        pair: &FramePair<'_>,
        arm: Arm,
        table: &Arc<LevelTable>,
        budget: &Budget,
    ) {
        let Footage { flocks, cameras, frame_s, .. } = pair.footage;
        let mut selector = Selector::with_policy(arm.policy(table), table.clone());
        let mut levels = [Vec::new(), Vec::new()];
        let mut before: Vec<InstanceLevel> = Vec::new();
        for (frame, seen) in pair.run().zip(pair.visible) {
            let visible = arm.skips_occluded().then_some(&seen[..]);
            let start = Instant::now();
            let chosen = selector.select_visible(&flocks[frame], &cameras[frame], budget, visible);
            self.choice_seconds += start.elapsed().as_secs_f64();
            self.choices += 1;
            self.count_switches(&before, chosen, table, *frame_s);
            before = chosen.to_vec();
            if frame >= pair.first {
                self.triangles.push(selector.triangles());
                levels[frame - pair.first].clone_from(&before);
            }
        }
        if *pair.run().end() == pair.first {
            levels[1] = levels[0].clone();
            self.triangles.extend(self.triangles.last().copied());
        }
        self.levels.push(levels);
    }

    /// Counts the members that are in view in two frames, and those that look different; `before`
    /// is empty in the first frame.
    fn count_switches(
        &mut self,
        before: &[InstanceLevel],
        chosen: &[InstanceLevel],
        table: &LevelTable,
        frame_s: f32,
    ) {
        if before.is_empty() {
            return;
        }
        let look = |level: &InstanceLevel| level.appearance(table);
        let both = before.iter().map(look).zip(chosen.iter().map(look));
        let in_view = both.filter(|(a, b)| a.is_some() && b.is_some());
        let (members, switches) =
            in_view.fold((0, 0), |(n, changed), (a, b)| (n + 1, changed + usize::from(a != b)));
        self.switches += switches;
        self.member_seconds += f64::from(members) * f64::from(frame_s);
    }

    pub fn mean_triangles(&self) -> f64 {
        mean(self.triangles.iter().map(|&count| count as f64))
    }

    /// Returns the changes of level per second and member in view.
    pub fn switches_per_second(&self) -> f64 {
        self.switches as f64 / f64::max(self.member_seconds, 1e-9)
    }

    /// Returns the mean time of a choice, in seconds.
    pub fn selection_seconds(&self) -> f64 {
        self.choice_seconds / self.choices.max(1) as f64
    }
}
