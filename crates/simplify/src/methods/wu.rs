//! Face constriction without volume conservation [Wu01].

use glam::DVec3;

use crate::engine::policy::Placement;
use crate::methods::creases::{Creases, Turns};
use crate::methods::lindstrom_turk;
use crate::refusal::Refusal;
use crate::surface::contracted::Freedom;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Placed, Surface};

/// VAR: weight of a vertex by the variance of its edges' turns (eq. 2 of [LJ05]). A vertex whose
/// edges are all alike has no weight, however sharp they are.
pub(crate) fn weight(turns: &Turns) -> f64 {
    turns.variance
}

/// Placement at the weighted mean of the corners (eq. 13 of [LJ05]).
pub(crate) struct WeightedMean;

impl Placement<Creases> for WeightedMean {
    fn place(
        &self,
        surface: &Surface,
        creases: &Creases,
        neighbourhood: &Neighbourhood,
    ) -> Result<Placed, Refusal> {
        if neighbourhood.freedom() != Freedom::Free || neighbourhood.contracted().len() == 2 {
            return lindstrom_turk::place(surface, neighbourhood);
        }
        let corners = || {
            neighbourhood
                .contracted()
                .iter()
                .map(|&v| (surface.position(v), f64::from(creases.at(surface, v).weight)))
        };
        let weights: f64 = corners().map(|(_, weight)| weight).sum();
        let position = if weights > 0.0 {
            corners().map(|(p, weight)| p * (weight / weights)).sum()
        } else {
            corners().map(|(p, _)| p).sum::<DVec3>() / 3.0
        };
        Ok(Placed { position, kept: 0, error_estimate: 0.0 })
    }
}
