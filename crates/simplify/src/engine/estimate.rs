//! Estimate of the distance from the input to the surface after a contraction; it is not an upper
//! bound.

use glam::DVec3;
use meshlod_mesh::VertexId;
use meshlod_spatial::closest_point;

use crate::surface::neighbourhood::{Neighbourhood, Spoke};
use crate::surface::{Placed, Surface};

/// Returns the estimated distance between the input and the surface after a contraction, in model
/// units.
///
/// This combines the larger of the placement's own estimate and the distance of the contracted
/// vertices from the new faces with the distance moved before. The two are taken as independent.
pub(crate) fn estimate(surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) -> f64 {
    let now = placed.error_estimate.max(stand_off(surface, neighbourhood, placed.position));
    now.hypot(surface.moved(neighbourhood.contracted()))
}

/// Returns the distance of the contracted vertices from their own faces with the corner moved to
/// `position`, or from all surviving faces if a vertex had only removed ones. Quadrics miss the tip
/// of a spike, because its planes all pass close to its foot.
fn stand_off(surface: &Surface, neighbourhood: &Neighbourhood, position: DVec3) -> f64 {
    let ring = |place: u32| neighbourhood.ring()[place as usize].position;
    let squared = |v: DVec3, spoke: &Spoke| {
        v.distance_squared(closest_point(v, &[position, ring(spoke.a), ring(spoke.b)]))
    };
    let mut nearest = [f64::INFINITY; 3];
    for spoke in neighbourhood.spokes() {
        let v = surface.position(neighbourhood.contracted()[spoke.owner()]);
        let nearest = &mut nearest[spoke.owner()];
        *nearest = nearest.min(squared(v, spoke));
    }
    let of_one = |(&v, own): (&VertexId, f64)| {
        let v = surface.position(v);
        let all =
            || neighbourhood.spokes().iter().map(|spoke| squared(v, spoke)).fold(own, f64::min);
        if own.is_finite() { own } else { all() }
    };
    neighbourhood.contracted().iter().zip(nearest).map(of_one).fold(0.0, f64::max).sqrt()
}
