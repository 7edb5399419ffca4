//! How far the surface has moved, vertex by vertex: the estimate of methods whose costs are no
//! distances.

use glam::DVec3;
use meshlod_mesh::VertexId;
use meshlod_spatial::closest_point;

use crate::neighbourhood::{Neighbourhood, Spoke};
use crate::policy::Memory;
use crate::surface::{Placed, Surface};

/// For each vertex an estimate of how far the surface has moved there, in model units.
pub(crate) struct Drift(Vec<f32>);

impl Drift {
    pub(crate) fn new(surface: &Surface) -> Self {
        Self(vec![0.0; surface.vertex_count()])
    }

    /// How far a contraction to `position` takes the surface from where it was at first; what is
    /// moved now counts at least `least`.
    ///
    /// What was moved before and what is moved now are taken as independent.
    pub(crate) fn estimate(
        &self,
        surface: &Surface,
        hood: &Neighbourhood,
        position: DVec3,
        least: f64,
    ) -> f64 {
        let before = hood.contracted().iter().map(|v| self.0[v.index()]).fold(0.0, f32::max);
        stand_off(surface, hood, position).max(least).hypot(before.into())
    }
}

impl Memory for Drift {
    fn merge(&mut self, _: &Surface, hood: &Neighbourhood, placed: &Placed) {
        self.0[hood.contracted()[placed.kept].index()] = placed.error_estimate as f32;
    }
}

/// How far the contracted vertices are from the faces they had and that now meet in `position`; one
/// that had none but dying ones, from all that survive. Quadrics do not see the tip of a spike: its
/// planes all pass close by its foot.
fn stand_off(surface: &Surface, hood: &Neighbourhood, position: DVec3) -> f64 {
    let ring = |place: u32| hood.ring()[place as usize].position;
    let squared = |v: DVec3, spoke: &Spoke| {
        v.distance_squared(closest_point(v, &[position, ring(spoke.a), ring(spoke.b)]))
    };
    let mut nearest = [f64::INFINITY; 3];
    for spoke in hood.spokes() {
        let v = surface.position(hood.contracted()[spoke.owner()]);
        let nearest = &mut nearest[spoke.owner()];
        *nearest = nearest.min(squared(v, spoke));
    }
    let of_one = |(&v, own): (&VertexId, f64)| {
        let v = surface.position(v);
        let all = || hood.spokes().iter().map(|spoke| squared(v, spoke)).fold(own, f64::min);
        if own.is_finite() { own } else { all() }
    };
    hood.contracted().iter().zip(nearest).map(of_one).fold(0.0, f64::max).sqrt()
}
