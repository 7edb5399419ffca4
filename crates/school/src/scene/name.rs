//! Names of the scenarios.

use serde::{Deserialize, Serialize};

/// Scenario of this crate by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ScenarioName {
    /// The camera follows a school and circles it, near and far by turns [CC05].
    Ring,
    /// The camera swims inside the school and looks round.
    Inside,
    /// The camera circles the school at a great distance.
    Far,
    /// The school parts round balls, pillars and bars; the camera keeps abreast.
    Obstacles,
    /// The school swims over a terrain; the camera looks down on it from behind.
    Terrain,
}

impl ScenarioName {
    /// All scenarios in a fixed order.
    pub const ALL: [Self; 5] =
        [Self::Ring, Self::Inside, Self::Far, Self::Obstacles, Self::Terrain];

    /// Returns the name as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ring => "ring",
            Self::Inside => "inside",
            Self::Far => "far",
            Self::Obstacles => "obstacles",
            Self::Terrain => "terrain",
        }
    }
}

meshlod::mesh::by_name!(ScenarioName, "scenarios");
