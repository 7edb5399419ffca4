//! The request for a simplification.

use meshlod_io::Scene;
use meshlod_simplify::{AttributeWeights, Method, Target};

use crate::jobs::WrittenAs;
use crate::scene::world_bounds;
use crate::{Bound, Constraints};

/// Request to simplify a scene; see [`simplify`](super::simplify).
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct SimplifyRequest {
    /// Number of faces or error at which to stop.
    pub target: Aim,
    /// Method that contracts.
    pub method: Method,
    /// Weights of attributes in the costs of the method.
    pub weights: AttributeWeights,
    /// Weight of boundaries in the costs; `None` for that of the method.
    pub boundary: Option<f64>,
    /// True to fit the vertices of the level to the input once more, all together, if a number of
    /// faces is asked for.
    pub polish: bool,
    /// Constraints on the level.
    pub constraints: Constraints,
    /// True to restore the volume of closed parts, exactly in the digits that are written.
    pub exact_volume: bool,
    /// True to measure the distance from the input, at points. Meshes that are shown many times are
    /// measured once, each against its own level.
    pub measured: bool,
    /// True to look for boundary edges near each other, which welding would join.
    pub near_borders: bool,
    /// How the result will be written, for which an error then is proved; `None` if it stays in
    /// memory.
    pub written_as: Option<WrittenAs>,
}

/// Number of faces or error at which a simplification of a scene stops.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Aim {
    /// At most this number of faces, over all instances.
    Faces(usize),
    /// At most this fraction of the faces, from 0 to 1; of those before fusing.
    Ratio(f64),
    /// As few faces as possible with a distance of at most this, in both directions.
    Error(Bound),
}

/// Half of the faces.
impl Default for Aim {
    fn default() -> Self {
        Self::Ratio(0.5)
    }
}

impl From<Target> for Aim {
    fn from(target: Target) -> Self {
        match target {
            Target::Faces(faces) => Self::Faces(faces),
            Target::Ratio(ratio) => Self::Ratio(ratio),
            Target::Error(error) => Self::Error(Bound::Length(error)),
        }
    }
}

impl Aim {
    /// Returns the target for a scene, with an error in world units.
    pub(super) fn target(self, scene: &Scene) -> Target {
        match self {
            Self::Faces(faces) => Target::Faces(faces),
            Self::Ratio(ratio) => Target::Ratio(ratio),
            Self::Error(bound) => Target::Error(bound.length(world_bounds(scene).diagonal())),
        }
    }
}
