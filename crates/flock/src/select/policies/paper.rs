//! The paper's three factors together.

use serde::{Deserialize, Serialize};

use crate::levels::LevelTable;
use crate::select::policies::by_school::each_school;
use crate::select::policies::direction::SidedLevels;
use crate::select::policies::layer::Shells;
use crate::select::policies::relative_distance::{Along, RelativeTo};
use crate::select::{InstanceLevel, Policy, View};

/// Gives every member a level by its distance relative to the leader's, the side that the school
/// turns to the camera, and its depth in the school [CC05].
pub struct Paper {
    chains: SidedLevels,
    factors: Factors,
}

/// Factors of the paper that take part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Factors {
    /// All three.
    All,
    /// All but the direction: levels of the whole chain.
    WithoutDirection,
    /// All but the layer.
    WithoutLayer,
}

impl Paper {
    /// Creates the policy for a table of levels.
    pub fn new(_table: &LevelTable) -> Self {
        Self { chains: SidedLevels::default(), factors: Factors::All }
    }

    /// Returns the policy with only some of its factors.
    pub fn with(self, factors: Factors) -> Self {
        Self { factors, ..self }
    }
}

impl Policy for Paper {
    fn select(&mut self, view: &View<'_>, levels: &mut [InstanceLevel]) {
        self.chains.fill(view);
        each_school(view, levels, self.chains.whole(), |school, levels| {
            let by_distance = match self.factors {
                Factors::WithoutDirection => self.chains.whole(),
                _ => self.chains.of(view, school),
            };
            let distance = RelativeTo::new(view, school, Along::Leader);
            let shells = Shells::new(view, school);
            let range = school.members.clone();
            if self.factors == Factors::WithoutLayer {
                view.assign_range(range, levels, |_, lanes, chosen| {
                    by_distance.look_up(&distance.squares(lanes), chosen);
                });
            } else {
                view.assign_range(range, levels, |_, lanes, chosen| {
                    let mut squares = distance.squares(lanes);
                    shells.scale(lanes, &mut squares);
                    by_distance.look_up(&squares, chosen);
                });
            }
        });
    }
}
