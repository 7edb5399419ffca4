//! Edge contraction ordered by quadrics, with positions moved to conserve the volume [KJ04].

use glam::DVec3;

use crate::engine::Algorithm;
use crate::engine::candidates::EdgeCandidates;
use crate::engine::policy::Placement;
use crate::engine::prepared_surface::PreparedSurface;
use crate::methods::qem::{Optimal, Quadrics, Recipe};
use crate::methods::volume::{VolumePlane, along_normal};
use crate::options::Options;
use crate::refusal::Refusal;
use crate::run::Run;
use crate::surface::contracted::Freedom;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Placed, Surface};

/// Limit on moving the optimum along the line from the middle of the ring, in units of the mean
/// spoke; beyond it, the shortest way is taken.
const REACH: f64 = 0.5;

/// Starts the method.
pub(super) fn start(options: &Options, ready: PreparedSurface) -> Box<dyn Run> {
    Algorithm {
        candidates: EdgeCandidates,
        memory: Quadrics::new(Recipe::OURS, options, &ready, ()),
        priority: Optimal,
        placement: VolumeConserving,
    }
    .start(ready)
}

/// Placement at the quadric optimum, moved along the line from the middle of the ring until the
/// volume is conserved, or by the shortest way where that line is nearly parallel to the surface.
/// At a boundary the volume is that behind the cones that close it.
struct VolumeConserving;

impl Placement<Quadrics> for VolumeConserving {
    fn place(
        &self,
        surface: &Surface,
        memory: &Quadrics,
        neighbourhood: &Neighbourhood,
    ) -> Result<Placed, Refusal> {
        let placed = Optimal.place(surface, memory, neighbourhood)?;
        if let Freedom::AlongNormal(kept) = neighbourhood.freedom() {
            let position = along_normal(surface, neighbourhood, kept)?;
            return Ok(Placed { position, ..placed });
        }
        if neighbourhood.freedom() != Freedom::Free || neighbourhood.ring().is_empty() {
            return Ok(placed);
        }
        let ring = neighbourhood.ring();
        let base = ring.iter().map(|r| r.position).sum::<DVec3>() / ring.len() as f64;
        let spoke = ring.iter().map(|r| r.position.distance(base)).sum::<f64>() / ring.len() as f64;
        let plane = VolumePlane::new(surface, neighbourhood, base);
        let optimum = placed.position - base;
        // N = E + (Vol_b / Vol_c)(C − E), with E as the origin of the offsets.
        let along = optimum * (plane.level / plane.normal.dot(optimum));
        let offset =
            if along.distance(optimum) <= REACH * spoke { along } else { plane.nearest(optimum) };
        // Where the faces nearly cancel, as in folds, that plane can be anywhere.
        if offset.length() > neighbourhood.radius(base) {
            return Err(Refusal::Volume);
        }
        Ok(Placed { position: base + offset, ..placed })
    }
}
