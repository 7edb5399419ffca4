//! Names of the policies.

use serde::{Deserialize, Serialize};

use crate::levels::LevelTable;
use crate::select::Policy;
use crate::select::policies::{
    Budgeted, Direction, Distance, Eccentricity, FullDetail, Layer, Ours, Paper, RelativeDistance,
    ScreenError, Speed,
};

/// Policy of this crate by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PolicyName {
    /// Full detail.
    None,
    /// By the distance of the member.
    Distance,
    /// By the error of the level in pixels.
    ScreenError,
    /// By the size of the member on the screen, under a budget of triangles, with hysteresis.
    Budget,
    /// By the distance of the leader and the member's place in the school [CC05].
    RelativeDistance,
    /// By distance, with the side coarsened that the whole school turns away [CC05].
    Direction,
    /// By distance and depth in the school [CC05].
    Layer,
    /// By distance and the member's speed over the screen.
    Speed,
    /// By distance and the angle from where the viewer looks.
    Eccentricity,
    /// By relative distance, direction and layer together [CC05].
    Paper,
    /// By what each triangle adds to the picture, under a budget of triangles.
    Ours,
}

impl PolicyName {
    /// All policies in a fixed order.
    pub const ALL: [Self; 11] = [
        Self::None,
        Self::Distance,
        Self::ScreenError,
        Self::Budget,
        Self::RelativeDistance,
        Self::Direction,
        Self::Layer,
        Self::Speed,
        Self::Eccentricity,
        Self::Paper,
        Self::Ours,
    ];

    /// Returns the name as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Distance => "distance",
            Self::ScreenError => "screen-error",
            Self::Budget => "budget",
            Self::RelativeDistance => "relative-distance",
            Self::Direction => "direction",
            Self::Layer => "layer",
            Self::Speed => "speed",
            Self::Eccentricity => "eccentricity",
            Self::Paper => "paper",
            Self::Ours => "ours",
        }
    }

    /// Returns true if the policy keeps to [`Budget::triangles`](crate::select::Budget::triangles).
    pub fn has_budget(self) -> bool {
        matches!(self, Self::Budget | Self::Ours)
    }

    /// Creates the policy for a table of levels.
    pub fn policy(self, table: &LevelTable) -> Box<dyn Policy> {
        match self {
            Self::None => Box::new(FullDetail),
            Self::Distance => Box::new(Distance::new(table)),
            Self::ScreenError => Box::new(ScreenError::new(table)),
            Self::Budget => Box::new(Budgeted::new(table)),
            Self::RelativeDistance => Box::new(RelativeDistance::new(table)),
            Self::Direction => Box::new(Direction::new(table)),
            Self::Layer => Box::new(Layer::new(table)),
            Self::Speed => Box::new(Speed::new(table)),
            Self::Eccentricity => Box::new(Eccentricity::new(table)),
            Self::Paper => Box::new(Paper::new(table)),
            Self::Ours => Box::new(Ours::new(table)),
        }
    }
}

meshlod_mesh::by_name!(PolicyName, "policies");
