//! Policies, one a file.
//!
//! Those of the paper share one scale: a member at a distance `d` gets the share `NEAR * detail / d`
//! of its triangles, and a factor makes it count as farther away than it is.

mod budgeted;
mod direction;
mod distance;
mod eccentricity;
mod full_detail;
mod layer;
mod ours;
mod paper;
mod relative_distance;
mod screen_error;
mod speed;

pub use budgeted::Budgeted;
pub use direction::{Direction, SidedLevels};
pub use distance::Distance;
pub use eccentricity::Eccentricity;
pub use full_detail::FullDetail;
pub use layer::{Layer, SHELLS};
pub use ours::Ours;
pub use paper::{Factors, Paper};
pub use relative_distance::{Along, RelativeDistance, RelativeTo};
pub use screen_error::ScreenError;
pub use speed::Speed;

use crate::flock::School;
use crate::levels::Chain;
use crate::select::{ChainLevels, InstanceLevel, View};

/// Distance up to which a member has all its triangles at a detail of 1, in body lengths.
const NEAR: f32 = 4.0;

/// Fills the levels of a chain by the paper's F(d) = 1/d, as a share of the triangles.
fn fill_by_distance(levels: &mut ChainLevels, view: &View<'_>, chain: &Chain) {
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
    let alone = |range: std::ops::Range<usize>, levels: &mut [InstanceLevel]| {
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
