//! Face constriction without volume conservation [Wu01].

use glam::DVec3;

use crate::engine::Algorithm;
use crate::engine::candidates::FaceAndEdgeCandidates;
use crate::engine::policy::Placement;
use crate::engine::prepared_surface::PreparedSurface;
use crate::methods::creases::{Creases, Turns};
use crate::methods::face_order::FaceOrder;
use crate::methods::lindstrom_turk;
use crate::refusal::Refusal;
use crate::run::Run;
use crate::surface::contracted::Freedom;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Placed, Surface};

/// Starts the method.
pub(super) fn start(ready: PreparedSurface) -> Box<dyn Run> {
    let surface = &ready.surface;
    Algorithm {
        candidates: FaceAndEdgeCandidates,
        memory: Creases::new(surface, weight),
        priority: FaceOrder::new(surface),
        placement: WeightedMean,
    }
    .start(ready)
}

/// VAR: weight of a vertex by the variance of its edges' turns (eq. 2 of [LJ05]). A vertex whose
/// edges are all alike has no weight, however sharp they are.
pub(super) fn weight(turns: &Turns) -> f64 {
    turns.variance
}

/// Placement at the weighted mean of the corners (eq. 13 of [LJ05]).
struct WeightedMean;

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
