//! Edge contraction in the order of quadrics, moved to where the volume stays [KJ04].

use glam::DVec3;

use crate::engine::policy::Placement;
use crate::methods::qem::{Optimal, Quadrics};
use crate::methods::volume::VolumePlane;
use crate::refusal::Refusal;
use crate::surface::contracted::Freedom;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Placed, Surface};

/// How far, in mean spokes of its own, the optimum may be moved along the line from the middle of
/// the ring; beyond, it goes the shortest way.
const REACH: f64 = 0.5;

/// The optimum of the quadrics, moved along the line from the middle of the ring to where it
/// conserves the volume; by the shortest way where that line hardly leaves the surface. An open ring
/// has no volume; there it is the optimum.
pub(crate) struct VolumeConserving;

impl Placement<Quadrics> for VolumeConserving {
    fn place(
        &self,
        surface: &Surface,
        memory: &Quadrics,
        neighbourhood: &Neighbourhood,
    ) -> Result<Placed, Refusal> {
        let placed = Optimal.place(surface, memory, neighbourhood)?;
        if neighbourhood.freedom() != Freedom::Free
            || !neighbourhood.is_closed(surface)
            || neighbourhood.ring().is_empty()
        {
            return Ok(placed);
        }
        let ring = neighbourhood.ring();
        let base = ring.iter().map(|r| r.position).sum::<DVec3>() / ring.len() as f64;
        let spoke = ring.iter().map(|r| r.position.distance(base)).sum::<f64>() / ring.len() as f64;
        let plane = VolumePlane::new(surface, neighbourhood, base);
        let optimum = placed.position - base;
        // N = E + (Vol_b / Vol_c)(C − E), E being where offsets start.
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
