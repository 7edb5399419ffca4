//! Contraction of all edges that connect the same two ties in one step, to one position.

use crate::engine::Engine;
use crate::engine::checks::{flip, topology};
use crate::engine::estimate::estimate;
use crate::engine::policy::{Candidates, Memory, Observe, Placement, Priority, Stop};
use crate::refusal::Refusal;
use crate::surface::Placed;
use crate::surface::contracted::{Contracted, Freedom};
use crate::surface::neighbourhood::Neighbourhood;

impl<C, M, P, L> Engine<C, M, P, L>
where
    C: Candidates,
    M: Memory,
    P: Priority<M>,
    L: Placement<M>,
{
    /// Contracts an edge together with the edges that ties connect to it, after all of them have
    /// passed all checks.
    ///
    /// The history records one contraction per edge.
    pub(super) fn contract_tied(
        &mut self,
        stop: &Stop,
        observer: &mut dyn Observe,
    ) -> Result<(), Refusal> {
        self.gather_tied()?;
        let count = self.neighbourhood.partners.len();
        let placed = self.place_tied(count)?;
        let Self { surface, neighbourhood, tied, .. } = self;
        let all = || std::iter::once(&*neighbourhood).chain(&tied[..count]);
        let errors: Vec<f64> =
            all().map(|neighbourhood| estimate(surface, neighbourhood, &placed)).collect();
        if errors.iter().any(|&error| error > stop.error) {
            return Err(Refusal::Error);
        }
        all().try_for_each(|neighbourhood| flip(surface, neighbourhood, placed.position))?;
        // Each neighbourhood is still valid, since no two edges share a face.
        for (i, error_estimate) in errors.into_iter().enumerate() {
            if let Some(partner) = i.checked_sub(1) {
                std::mem::swap(&mut self.neighbourhood, &mut self.tied[partner]);
                // Its position is dictated by the tie.
                self.neighbourhood.freedom = Freedom::At(placed.kept);
            }
            self.apply(&Placed { error_estimate, ..placed }, observer);
        }
        Ok(())
    }

    /// Gathers the neighbourhoods of the partners, and restricts all to their common freedom.
    fn gather_tied(&mut self) -> Result<(), Refusal> {
        let Self { surface, neighbourhood, tied, .. } = self;
        let partners = std::mem::take(&mut neighbourhood.partners);
        if tied.len() < partners.len() {
            tied.resize_with(partners.len(), Neighbourhood::default);
        }
        let tied = &mut tied[..partners.len()];
        let mut freedom = neighbourhood.freedom;
        for (partner, &edge) in tied.iter_mut().zip(&partners) {
            partner.gather(surface, Contracted::edge(edge))?;
            topology(surface, partner)?;
            freedom = freedom.and(partner.freedom).ok_or(Refusal::Tied)?;
        }
        neighbourhood.partners = partners;
        if !are_apart(neighbourhood, tied) {
            return Err(Refusal::Tied);
        }
        // Tied vertices would not stay together if each moved along its own normal.
        let freedom = freedom.kept().map_or(Freedom::Free, Freedom::At);
        neighbourhood.freedom = freedom;
        tied.iter_mut().for_each(|partner| partner.freedom = freedom);
        Ok(())
    }

    /// Selects, among the positions that the method finds for each edge, the one with the smallest
    /// largest error.
    ///
    /// Its error estimate is the greatest that the method gives for any of them.
    fn place_tied(&self, count: usize) -> Result<Placed, Refusal> {
        let Self { algorithm, surface, neighbourhood, tied, .. } = self;
        let all = || std::iter::once(neighbourhood).chain(&tied[..count]);
        let place =
            |neighbourhood| algorithm.placement.place(surface, &algorithm.memory, neighbourhood);
        let places = all().map(place).collect::<Result<Vec<Placed>, _>>()?;
        let error_estimate = places.iter().map(|p| p.error_estimate).fold(0.0, f64::max);
        let farthest = |placed: &Placed| {
            all().map(|neighbourhood| estimate(surface, neighbourhood, placed)).fold(0.0, f64::max)
        };
        let scored = places.into_iter().map(|placed| {
            let placed = Placed { error_estimate: 0.0, ..placed };
            (farthest(&placed), placed)
        });
        let best = scored.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map(|(_, placed)| Placed { error_estimate, ..placed }).ok_or(Refusal::Tied)
    }
}

/// Returns true if no two edges share a neighbouring face.
fn are_apart(neighbourhood: &Neighbourhood, tied: &[Neighbourhood]) -> bool {
    let all = || std::iter::once(neighbourhood).chain(tied);
    let at = |neighbourhood: &Neighbourhood, other: &Neighbourhood| {
        neighbourhood.ring.iter().any(|r| other.contracted.contains(&r.id))
    };
    all().enumerate().all(|(i, neighbourhood)| {
        all().enumerate().all(|(j, other)| i == j || !at(neighbourhood, other))
    })
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::grid;
    use meshlod_mesh::{Connectivity, VertexId};

    use super::*;
    use crate::surface::Surface;

    #[test]
    fn edges_with_a_face_around_both_are_not_apart() {
        // Vertex x + 7y is at (x, y).
        let mesh = grid(6);
        let connectivity = Connectivity::new(&mesh.faces, mesh.positions.len());
        let surface = Surface::new(&mesh, &connectivity);
        let around = |edge: [u32; 2]| {
            let mut neighbourhood = Neighbourhood::default();
            neighbourhood.gather(&surface, Contracted::edge(edge.map(VertexId))).unwrap();
            neighbourhood
        };
        let neighbourhood = around([8, 9]);
        // One row up, and two, where only the rings meet.
        assert!(!are_apart(&neighbourhood, &[around([15, 16])]));
        assert!(are_apart(&neighbourhood, &[around([22, 23])]));
        assert!(!are_apart(&neighbourhood, &[around([29, 30]), around([22, 23])]));
    }
}
