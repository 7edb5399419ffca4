//! Arms of the comparison: policies, the usual choice of engines, and controls.

use meshlod::flock::levels::LevelTable;
use meshlod::flock::select::policies::{Along, Factors, Paper, RelativeDistance};
use meshlod::flock::select::{Policy, PolicyName};
use serde::{Deserialize, Serialize};

use crate::evaluate::controls::{RandomLevels, ScreenErrorFacing, ShuffledLayer};

/// One of the ways of choosing levels that an evaluation compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Arm {
    /// Policy by its name.
    Policy(PolicyName),
    /// Policy by its name; members without a visible pixel in full detail are skipped.
    VisibleOnly(PolicyName),
    /// Control: levels by their error in pixels, without back faces, which `ours` omits, too.
    ScreenErrorFacing,
    /// Paper's policy without one of its factors.
    Paper(Factors),
    /// Paper's policy without one of its factors; members without a visible pixel are skipped.
    VisiblePaper(Factors),
    /// Relative distance along the view axis, as printed.
    RelativeDistanceAsPrinted,
    /// Control: levels at random.
    Random,
    /// Control: the paper's policy with the layers of other members.
    ShuffledLayer,
}

impl Arm {
    /// All arms in a fixed order, except full detail, the reference.
    pub fn all() -> Vec<Self> {
        let policies = PolicyName::ALL.into_iter().filter(|policy| *policy != PolicyName::None);
        let visible =
            [PolicyName::ScreenError, PolicyName::Budget, PolicyName::Paper, PolicyName::Ours];
        let factors = [Factors::WithoutDirection, Factors::WithoutLayer];
        policies
            .map(Self::Policy)
            .chain(visible.map(Self::VisibleOnly))
            .chain(factors.map(Self::Paper))
            .chain(factors.map(Self::VisiblePaper))
            .chain([Self::ScreenErrorFacing])
            .chain([Self::RelativeDistanceAsPrinted, Self::Random, Self::ShuffledLayer])
            .collect()
    }

    /// Arms of the paper's figures 19 to 22 [CC05].
    pub fn of_the_paper() -> [Self; 6] {
        [
            Self::Policy(PolicyName::None),
            Self::Policy(PolicyName::Distance),
            Self::Policy(PolicyName::Paper),
            Self::Paper(Factors::WithoutDirection),
            Self::Paper(Factors::WithoutLayer),
            Self::Policy(PolicyName::RelativeDistance),
        ]
    }

    /// Returns the name of the arm in tables.
    pub fn name(self) -> String {
        match self {
            Self::Policy(policy) => policy.name().into(),
            Self::VisibleOnly(policy) => format!("{}, occluded skipped", policy.name()),
            Self::ScreenErrorFacing => "screen-error, facing chains".into(),
            Self::Paper(factors) => paper(factors).into(),
            Self::VisiblePaper(factors) => format!("{}, occluded skipped", paper(factors)),
            Self::RelativeDistanceAsPrinted => "relative-distance as printed".into(),
            Self::Random => "control: random".into(),
            Self::ShuffledLayer => "control: shuffled layers".into(),
        }
    }

    pub(super) fn policy(self, table: &LevelTable) -> Box<dyn Policy> {
        match self {
            Self::Policy(policy) | Self::VisibleOnly(policy) => policy.policy(table),
            Self::ScreenErrorFacing => Box::new(ScreenErrorFacing::new(table)),
            Self::Paper(factors) | Self::VisiblePaper(factors) => {
                Box::new(Paper::new(table).with(factors))
            }
            Self::RelativeDistanceAsPrinted => {
                Box::new(RelativeDistance::new(table).along(Along::View))
            }
            Self::Random => Box::new(RandomLevels::new(table)),
            Self::ShuffledLayer => Box::new(ShuffledLayer::new(table)),
        }
    }

    /// Returns true if the bias of the arm is its budget of triangles, not its detail.
    pub(super) fn has_budget(self) -> bool {
        matches!(self, Self::Policy(policy) | Self::VisibleOnly(policy) if policy.has_budget())
    }

    pub(super) fn skips_occluded(self) -> bool {
        matches!(self, Self::VisibleOnly(_) | Self::VisiblePaper(_))
    }
}

fn paper(factors: Factors) -> &'static str {
    match factors {
        Factors::All => "paper",
        Factors::WithoutDirection => "paper without direction",
        Factors::WithoutLayer => "paper without layer",
    }
}
