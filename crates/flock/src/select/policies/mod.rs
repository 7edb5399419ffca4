//! Policies, one a file, and the table of them: a new one is its file and a row here.
//!
//! Those of the paper share one scale: a member at a distance `d` gets the share `NEAR * detail / d`
//! of its triangles, and a factor makes it count as farther away than it is.

#[macro_use]
mod table;

mod budgeted;
mod direction;
mod distance;
mod eccentricity;
mod full_detail;
mod layer;
mod paper;
mod picture_gain;
mod relative_distance;
mod screen_error;
mod speed;

pub use budgeted::Budgeted;
pub use direction::{Direction, SidedLevels};
pub use distance::Distance;
pub use eccentricity::Eccentricity;
pub use full_detail::FullDetail;
pub use layer::{Layer, SHELLS};
pub use paper::{Factors, Paper};
pub use picture_gain::PictureGain;
pub use relative_distance::{Along, RelativeDistance, RelativeTo};
pub use screen_error::ScreenError;
pub use speed::Speed;
pub use table::Bias;

use crate::flock::School;
use crate::levels::Chain;
use crate::select::{ChainLevels, InstanceLevel, View};

policies! {
    /// Full detail.
    None = "none", "Full detail", '1', Bias::Nothing, FullDetail::new;
    /// By the distance of the member.
    Distance = "distance", "Distance", '2', Bias::Detail, Distance::new;
    /// By the error of the level in pixels.
    ScreenError = "screen-error", "Screen error", '3', Bias::Detail, ScreenError::new;
    /// By the size of the member on the screen, under a budget of triangles, with hysteresis.
    Budget = "budget", "Budget", '4', Bias::Triangles, Budgeted::new;
    /// By the distance of the leader and the member's place in the school [CC05].
    RelativeDistance =
        "relative-distance", "Relative distance", '5', Bias::Detail, RelativeDistance::new;
    /// By distance, with the side coarsened that the whole school turns away [CC05].
    Direction = "direction", "Direction", '6', Bias::Detail, Direction::new;
    /// By distance and depth in the school [CC05].
    Layer = "layer", "Layer", '7', Bias::Detail, Layer::new;
    /// By distance and the member's speed over the screen.
    Speed = "speed", "Speed", '8', Bias::Detail, Speed::new;
    /// By distance and the angle from where the viewer looks.
    Eccentricity = "eccentricity", "Eccentricity", '9', Bias::Detail, Eccentricity::new;
    /// By relative distance, direction and layer together [CC05].
    Paper = "paper", "Paper", '0', Bias::Detail, Paper::new;
    /// By what each triangle adds to the picture, under a budget of triangles.
    Ours = "ours", "Ours", '-', Bias::Triangles, PictureGain::new;
}

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
