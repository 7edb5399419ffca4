//! Policies, one a file, and the table of them: a new one is its file and its lines here.
//!
//! To read: `distance` and `screen_error`, the simplest; `by_school` with the paper's factors
//! `relative_distance`, `direction` and `layer`, and `paper`, all three together; `budgeted`, as in
//! engines; `picture_gain`, the policy `ours`.

#[macro_use]
mod table;

mod budgeted;
mod by_school;
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
pub use by_school::each_school;
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
