//! Plane of positions at which a new vertex conserves the volume.
//!
//! With the ring around a contraction fixed, the volume behind its faces is an affine function of
//! the new vertex. The positions that conserve it therefore form a plane, exactly, for any closed
//! ring. At a boundary the [cones](crate::surface::rims) that close it complete the ring.

use glam::DVec3;
use meshlod_mesh::VertexId;

use crate::refusal::Refusal;
use crate::surface::Surface;
use crate::surface::feature_edges::feature_edges;
use crate::surface::neighbourhood::Neighbourhood;

/// Largest displacement along a normal, as a part of the distance to the farthest vertex around.
const REACH: f64 = 0.5;

/// Plane `normal`·x = `level`, where x is an offset from a given origin.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct VolumePlane {
    /// Sum of the normals of the replaced faces and cone faces, each twice the area long.
    pub(crate) normal: DVec3,
    /// Six times the volume between the origin and those faces.
    pub(crate) level: f64,
}

impl VolumePlane {
    /// Builds the plane of positions that conserve the volume in a contraction, with the cones at
    /// boundaries. `origin` should be near, because the volumes of distant faces cancel badly.
    pub(crate) fn new(surface: &Surface, neighbourhood: &Neighbourhood, origin: DVec3) -> Self {
        let mut plane = Self::default();
        old_faces(surface, neighbourhood, origin, |normal, corner| plane.add(normal, corner));
        plane.add_cones(surface, neighbourhood, origin);
        plane
    }

    #[inline]
    pub(crate) fn add(&mut self, normal: DVec3, corner: DVec3) {
        self.normal += normal;
        self.level += normal.dot(corner);
    }

    /// Adds the cones at boundaries.
    pub(crate) fn add_cones(
        &mut self,
        surface: &Surface,
        neighbourhood: &Neighbourhood,
        origin: DVec3,
    ) {
        cone_faces(surface, neighbourhood.contracted(), origin, |normal, corner| {
            self.add(normal, corner);
        });
    }

    /// Returns six times the volume lost if the new vertex is at `x`.
    #[inline]
    pub(crate) fn loss(&self, x: DVec3) -> f64 {
        self.level - self.normal.dot(x)
    }

    /// Returns the position nearest to `x` that conserves the volume; `x` itself if there is no
    /// such position.
    #[inline]
    pub(crate) fn nearest(&self, x: DVec3) -> DVec3 {
        self.along(x, self.normal)
    }

    /// Returns the position in a direction from `x` that conserves the volume; `x` itself if there
    /// is no such position.
    fn along(&self, x: DVec3, direction: DVec3) -> DVec3 {
        let moved = x + direction * (self.loss(x) / self.normal.dot(direction));
        if moved.is_finite() { moved } else { x }
    }

    /// Returns the position nearest to `x` that conserves the volume; `x` itself if that position is
    /// farther than a part of `radius`.
    pub(crate) fn nearest_within(&self, x: DVec3, radius: f64) -> DVec3 {
        let moved = self.nearest(x);
        if moved.distance(x) <= REACH * radius { moved } else { x }
    }
}

/// Returns the position on the surface's normal at the contracted vertex `kept` that conserves the
/// volume. Refuses a position that is out of reach.
pub(crate) fn along_normal(
    surface: &Surface,
    neighbourhood: &Neighbourhood,
    kept: usize,
) -> Result<DVec3, Refusal> {
    let from = surface.position(neighbourhood.contracted()[kept]);
    let star = surface.star(neighbourhood.contracted()[kept]);
    let normal = star.map(|face| surface.area_normal(face)).sum();
    let offset = VolumePlane::new(surface, neighbourhood, from).along(DVec3::ZERO, normal);
    let is_near = offset.length() <= REACH * neighbourhood.radius(from);
    if is_near { Ok(from + offset) } else { Err(Refusal::Volume) }
}

/// Calls `each` for every face that a contraction replaces, with its normal (twice the area long)
/// and one of its corners relative to `origin`.
#[inline]
pub(crate) fn old_faces(
    surface: &Surface,
    neighbourhood: &Neighbourhood,
    origin: DVec3,
    mut each: impl FnMut(DVec3, DVec3),
) {
    let mut contracted = [DVec3::ZERO; 3];
    for (slot, &v) in contracted.iter_mut().zip(neighbourhood.contracted().iter()) {
        *slot = surface.position(v) - origin;
    }
    let ring = |place: u32| neighbourhood.ring()[place as usize].position - origin;
    for spoke in neighbourhood.spokes() {
        let corner = contracted[spoke.owner()];
        each((ring(spoke.a) - corner).cross(ring(spoke.b) - corner), corner);
    }
    for removed in neighbourhood.removed_faces() {
        let [a, b, c] = surface.face(removed.face).map(|v| surface.position(v) - origin);
        each((b - a).cross(c - a), a);
    }
}

/// Calls `each` for the triangles of the cones at the boundary edges of some vertices, with the
/// normal, twice the area long, and a corner relative to `origin`.
fn cone_faces(
    surface: &Surface,
    contracted: &[VertexId],
    origin: DVec3,
    mut each: impl FnMut(DVec3, DVec3),
) {
    if contracted.iter().all(|&v| surface.rims.apex(v).is_none()) {
        return;
    }
    for edge in feature_edges(surface, contracted).into_iter().filter(|edge| edge.is_boundary) {
        let [from, to] = edge.ends;
        let Some(apex) = surface.rims.apex(from).or(surface.rims.apex(to)) else { continue };
        let [a, b] = [to, from].map(|v| surface.position(v) - origin);
        each((b - a).cross(apex - origin - a), a);
    }
}
