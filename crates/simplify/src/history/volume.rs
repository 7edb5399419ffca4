//! Observer that sums the change of the enclosed volume.

use glam::{DMat3, DMat4, DVec3};
use meshlod_mesh::{Bounds, FaceId};

use crate::engine::policy::Observe;
use crate::methods::volume::VolumePlane;
use crate::surface::contracted::Freedom;
use crate::surface::neighbourhood::{Neighbourhood, Spoke};
use crate::surface::{Flags, Placed, Surface};

/// Volume lost by contractions, and the contractions in which no method can conserve it. A
/// contracted face counts as two edges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct VolumeLoss {
    /// Volume before minus volume after, summed over all contractions with a closed ring, in cubic
    /// model units: table 2 of [LJ05]. Components that vanish are not in it.
    pub running_sum: f64,
    /// Part of the sum still owed by [`Method::LindstromTurk`](crate::Method::LindstromTurk) when
    /// contractions end, in cubic model units: a place that conserves the volume would have spoiled
    /// the shape.
    pub owed: f64,
    /// Part of the sum that the level has been repaid by
    /// [`Simplifier::settled_level`](crate::Simplifier::settled_level), in cubic model units: as
    /// much of the debt as the shape allows, and zero until then.
    pub repaid: f64,
    /// Sum of the absolute volumes of the closed components that were removed as a whole, in cubic
    /// model units.
    pub vanished: f64,
    /// Volume before minus volume after, summed over all contractions at a boundary, in cubic model
    /// units: behind the faces and cones that close them, from each boundary loop to its middle in
    /// the input. `None` without such contractions, and by the kernel, which has no cones.
    pub behind_boundary_cones: Option<f64>,
    /// Contractions at a boundary, and open components that were removed as a whole. `running_sum`
    /// leaves them out.
    pub at_boundaries: Unconserved,
    /// Contractions forced to one position by a lock, a tie or a seam, and closed components that
    /// were removed as a whole, each counted once. The sum includes the contractions. At a seam that
    /// holds, methods that conserve the volume move the vertex along the surface's normal, and are
    /// forced only where that would fold the surface.
    pub held: Unconserved,
}

/// Contractions whose position could not be chosen to conserve the volume.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Unconserved {
    /// Number of these contractions.
    pub contractions: usize,
    /// Bounding box of the positions of these contractions.
    pub bounds: Bounds,
}

impl VolumeLoss {
    /// Returns the volume that the parts in the level have lost, in cubic model units: the sum
    /// without what the level has been repaid.
    pub fn lost(&self) -> f64 {
        self.running_sum - self.repaid
    }

    /// Adds the volume lost by another mesh, placed by the matrix `transform` (columns, as in
    /// glTF).
    pub fn add(&mut self, other: &Self, transform: &[[f64; 4]; 4]) {
        let transform = DMat4::from_cols_array_2d(transform);
        let scale = DMat3::from_mat4(transform).determinant().abs();
        self.running_sum += other.running_sum * scale;
        self.owed += other.owed * scale;
        self.repaid += other.repaid * scale;
        if let Some(lost) = other.behind_boundary_cones {
            *self.behind_boundary_cones.get_or_insert(0.0) += lost * scale;
        }
        self.vanished += other.vanished * scale;
        self.at_boundaries.count_in(&other.at_boundaries, &transform);
        self.held.count_in(&other.held, &transform);
    }
}

impl Unconserved {
    fn count_in(&mut self, other: &Self, transform: &DMat4) {
        if other.contractions == 0 {
            return;
        }
        self.contractions += other.contractions;
        let Bounds { min, max } = other.bounds;
        for corner in 0..8 {
            let point = [0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { min } else { max }[axis]);
            self.bounds.add(transform.transform_point3(point.into()).into());
        }
    }

    fn add(&mut self, position: DVec3) {
        self.contractions += 1;
        self.bounds.add(position.into());
    }
}

impl Observe for VolumeLoss {
    fn before(&mut self, surface: &Surface, neighbourhood: &Neighbourhood, placed: &Placed) {
        if !neighbourhood.is_closed(surface) {
            let from = surface.position(neighbourhood.contracted()[placed.kept]);
            let plane = VolumePlane::new(surface, neighbourhood, from);
            *self.behind_boundary_cones.get_or_insert(0.0) +=
                plane.loss(placed.position - from) / 6.0;
            return self.at_boundaries.add(placed.position);
        }
        // Relative to the kept vertex, which is a corner of nearly all old faces.
        let kept = surface.position(neighbourhood.contracted()[placed.kept]);
        if neighbourhood.freedom() != Freedom::Free && placed.position == kept {
            self.held.add(placed.position);
        }
        let to = placed.position - kept;
        let sixfold = |spoke: &Spoke| {
            let [a, b] =
                [spoke.a, spoke.b].map(|r| neighbourhood.ring()[r as usize].position - kept);
            let from = surface.position(neighbourhood.contracted()[spoke.owner()]) - kept;
            a.cross(b).dot(from - to)
        };
        self.running_sum += neighbourhood.spokes().iter().map(sixfold).sum::<f64>() / 6.0;
    }

    fn vanish(&mut self, surface: &Surface, faces: &[FaceId]) {
        let corners = |&face: &FaceId| surface.face(face).map(|v| surface.position(v));
        let origin = faces.first().map_or(DVec3::ZERO, |face| corners(face)[0]);
        let ends_open = |face: &FaceId| {
            surface.face(*face).iter().any(|&v| surface.flags(v).any(Flags::BOUNDARY))
        };
        let kind = match faces.iter().any(ends_open) {
            true => &mut self.at_boundaries,
            false => {
                let sixfold = |face: &FaceId| {
                    let [a, b, c] = corners(face).map(|corner| corner - origin);
                    a.cross(b).dot(c)
                };
                self.vanished += (faces.iter().map(sixfold).sum::<f64>() / 6.0).abs();
                &mut self.held
            }
        };
        kind.add(origin);
        faces.iter().flat_map(corners).for_each(|corner| kind.bounds.add(corner.into()));
    }
}
