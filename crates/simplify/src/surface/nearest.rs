//! Closest points on the old faces around a contraction, from which the new vertex takes its
//! attributes, wedge by wedge.
//!
//! The new vertex is generally off the old faces and off the contracted edge. Each of its wedges
//! takes its values from the closest point of the old faces that it represents: those of its chart
//! for texture coordinates, those of the wedge itself for shading, so that a crease stays one.

use glam::DVec3;
use meshlod_mesh::{FaceId, WedgeId};
use meshlod_spatial::{Triangle, closest_point};

use crate::surface::interpolate::{Place, shares};
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::wedges::Wedges;
use crate::surface::{Placed, Surface};

/// Old face around a contraction, with its closest point to the new vertex.
struct Near {
    /// Wedge that its contracted corners become; `None` for one that meets no other.
    wedge: Option<WedgeId>,
    /// Chart that they become part of.
    chart: WedgeId,
    triangle: Triangle,
    wedges: [WedgeId; 3],
    /// Closest point to the new vertex.
    closest: DVec3,
    distance_squared: f64,
}

/// Faces around a contraction, as they were before it.
pub(crate) struct Nearby(Vec<Near>);

impl Nearby {
    pub(crate) fn new(
        wedges: &Wedges,
        surface: &Surface,
        neighbourhood: &Neighbourhood,
        placed: &Placed,
    ) -> Self {
        let near = |face: FaceId, wedge: Option<WedgeId>, chart: WedgeId| {
            let triangle = surface.face(face).map(|v| surface.position(v));
            let closest = closest_point(placed.position, &triangle);
            let distance_squared = placed.position.distance_squared(closest);
            Near { wedge, chart, triangle, wedges: wedges.of(face), closest, distance_squared }
        };
        let kept = placed.kept;
        let spokes = neighbourhood.spokes.iter().map(|spoke| {
            let (end, own) = (spoke.owner(), wedges.at(spoke.face, spoke.corner()));
            let becomes = neighbourhood.wedge_pairs.iter().find(|pair| pair[end] == own);
            let follows =
                neighbourhood.wedge_pairs.iter().find(|pair| wedges.same_chart(pair[end], own));
            let chart = becomes.or(follows).map_or(own, |pair| pair[kept]);
            near(spoke.face, becomes.map(|pair| pair[kept]), wedges.chart(chart))
        });
        let removed = neighbourhood.removed_faces.iter().map(|removed| {
            let corner = surface.corner(removed.face, neighbourhood.contracted[kept]);
            let own = wedges.at(removed.face, corner);
            near(removed.face, Some(own), wedges.chart(own))
        });
        Self(spokes.chain(removed).collect())
    }

    /// Returns the points from which this wedge of the new vertex takes its shading and its texture
    /// coordinates.
    pub(crate) fn places(&self, wedge: WedgeId, chart: WedgeId) -> [Option<Place>; 2] {
        let nearest = |counts: &dyn Fn(&Near) -> bool| {
            let faces = self.0.iter().filter(|near| counts(near));
            faces.min_by(|a, b| a.distance_squared.total_cmp(&b.distance_squared)).map(Near::place)
        };
        [nearest(&|near| near.wedge == Some(wedge)), nearest(&|near| near.chart == chart)]
    }
}

impl Near {
    fn place(&self) -> Place {
        Place { wedges: self.wedges, shares: shares(self.closest, &self.triangle) }
    }
}
