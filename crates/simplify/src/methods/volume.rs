//! Where a new vertex conserves the volume.
//!
//! With the ring around a contraction fixed, the volume behind its faces is an affine function of
//! the new vertex. So the places that conserve it are a plane: exactly, for any closed ring.

use glam::DVec3;

use crate::surface::Surface;
use crate::surface::neighbourhood::Neighbourhood;

/// The plane `normal`·x = `level`, x an offset from the origin that was given.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct VolumePlane {
    /// Twice the area of the faces that are replaced, along their normals.
    pub(crate) normal: DVec3,
    /// Six times the volume between the origin and those faces.
    pub(crate) level: f64,
}

impl VolumePlane {
    /// The plane for a gathered contraction, seen from `origin`, which should be near: volumes of
    /// what is far away cancel badly.
    pub(crate) fn new(surface: &Surface, neighbourhood: &Neighbourhood, origin: DVec3) -> Self {
        let mut plane = Self::default();
        old_faces(surface, neighbourhood, origin, |normal, corner| plane.add(normal, corner));
        plane
    }

    #[inline]
    pub(crate) fn add(&mut self, normal: DVec3, corner: DVec3) {
        self.normal += normal;
        self.level += normal.dot(corner);
    }

    /// Six times the volume that a vertex at `x` would lose.
    #[inline]
    pub(crate) fn loss(&self, x: DVec3) -> f64 {
        self.level - self.normal.dot(x)
    }

    /// The place nearest to `x` that conserves the volume; `x` where none does.
    #[inline]
    pub(crate) fn nearest(&self, x: DVec3) -> DVec3 {
        let moved = x + self.normal * (self.loss(x) / self.normal.length_squared());
        if moved.is_finite() { moved } else { x }
    }
}

/// Calls `each` with twice the area of every face around along its normal, and a corner of it seen
/// from `origin`.
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
    for dying in neighbourhood.dying() {
        let [a, b, c] = surface.face(dying.face).map(|v| surface.position(v) - origin);
        each((b - a).cross(c - a), a);
    }
}
