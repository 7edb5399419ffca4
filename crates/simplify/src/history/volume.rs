//! What contractions did to the volume, an observer.

use glam::{DMat3, DMat4, DVec3};
use meshlod_mesh::{Bounds, FaceId};

use crate::engine::policy::Observe;
use crate::surface::contracted::Freedom;
use crate::surface::neighbourhood::{Neighbourhood, Spoke};
use crate::surface::{Flags, Placed, Surface};

/// The volume that contractions lost, and those that no method can make conserve it. All are of edges:
/// a face counts as the two that it is contracted as.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VolumeLoss {
    /// The sum over all contractions with a closed ring of the volume before less the volume after,
    /// in model units cubed: table 2 of [LJ05].
    pub running_sum: f64,
    /// Contractions with a vertex on the boundary, and open components that vanished: there is no
    /// volume, and they are not in the sum.
    pub open: Unconserved,
    /// Contractions that a lock, a tie or a seam held to one place, and closed components that
    /// vanished, each as one. They are in the sum.
    pub held: Unconserved,
}

/// Contractions that could not choose their place by the volume.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Unconserved {
    /// How many.
    pub contractions: usize,
    /// The box of where they were.
    pub bounds: Bounds,
}

impl VolumeLoss {
    /// Counts another in, of a mesh that is shown through `transform` (columns, as glTF has them).
    pub fn add(&mut self, other: &Self, transform: &[[f64; 4]; 4]) {
        let transform = DMat4::from_cols_array_2d(transform);
        self.running_sum += other.running_sum * DMat3::from_mat4(transform).determinant().abs();
        self.open.count_in(&other.open, &transform);
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
    fn before(&mut self, surface: &Surface, hood: &Neighbourhood, placed: &Placed) {
        if !hood.is_closed(surface) {
            return self.open.add(placed.position);
        }
        if hood.freedom() != Freedom::Free {
            self.held.add(placed.position);
        }
        // Seen from the kept vertex, which is a corner of nearly all the faces before.
        let kept = surface.position(hood.contracted()[placed.kept]);
        let to = placed.position - kept;
        let sixfold = |spoke: &Spoke| {
            let [a, b] = [spoke.a, spoke.b].map(|r| hood.ring()[r as usize].position - kept);
            let from = surface.position(hood.contracted()[spoke.owner()]) - kept;
            a.cross(b).dot(from - to)
        };
        self.running_sum += hood.spokes().iter().map(sixfold).sum::<f64>() / 6.0;
    }

    fn vanish(&mut self, surface: &Surface, faces: &[FaceId]) {
        let corners = |&face: &FaceId| surface.face(face).map(|v| surface.position(v));
        let origin = faces.first().map_or(DVec3::ZERO, |face| corners(face)[0]);
        let ends_open = |face: &FaceId| {
            surface.face(*face).iter().any(|&v| surface.flags(v).any(Flags::BOUNDARY))
        };
        let kind = match faces.iter().any(ends_open) {
            true => &mut self.open,
            false => {
                let sixfold = |face: &FaceId| {
                    let [a, b, c] = corners(face).map(|corner| corner - origin);
                    a.cross(b).dot(c)
                };
                self.running_sum += faces.iter().map(sixfold).sum::<f64>() / 6.0;
                &mut self.held
            }
        };
        kind.add(origin);
        faces.iter().flat_map(corners).for_each(|corner| kind.bounds.add(corner.into()));
    }
}
