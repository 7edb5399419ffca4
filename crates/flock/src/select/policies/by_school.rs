//! Scale that the paper's policies share: a member at a distance `d` gets the fraction
//! `NEAR * detail / d` of its triangles, and a factor makes it count as farther away.

use std::ops::Range;

use crate::flock::School;
use crate::levels::Chain;
use crate::select::{ChainLevels, InstanceLevel, View};

/// Distance up to which a member has all its triangles at a detail of 1, in body lengths.
const NEAR: f32 = 4.0;

/// Fills the levels of a chain by the paper's F(d) = 1/d, as a share of the triangles.
pub(super) fn fill_by_distance(levels: &mut ChainLevels, view: &View<'_>, chain: &Chain) {
    let near = NEAR * view.detail();
    levels.fill_by_share(view.table, chain, |distance| near / distance);
}

/// Runs `choose` for every school; members of no school get levels by their own distance.
pub fn each_school(
    view: &View<'_>,
    levels: &mut [InstanceLevel],
    by_distance: &ChainLevels,
    mut choose: impl FnMut(&School, &mut [InstanceLevel]),
) {
    let mut next = 0;
    let alone = |range: Range<usize>, levels: &mut [InstanceLevel]| {
        view.assign_range(range, levels, |_, lanes, chosen| {
            by_distance.look_up(&lanes.distance_squared, chosen);
        });
    };
    let count = levels.len();
    for school in &view.flock.schools {
        // Schools overlap or reach beyond the members only by mistake.
        let start = school.members.start.clamp(next, count);
        let end = school.members.end.clamp(start, count);
        alone(next..start, levels);
        choose(&School { members: start..end, ..school.clone() }, levels);
        next = end;
    }
    alone(next..count, levels);
}
