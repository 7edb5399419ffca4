//! Faces of two instances that may meet, found by bounding boxes.

use glam::{DMat4, DVec3};
use meshlod_io::Scene;
use meshlod_mesh::{Bounds, FaceId, Mesh, VertexId};
use meshlod_spatial::Bvh;
use rayon::prelude::*;

use super::placed::{PlacedInstances, PlacedMesh};
use crate::scene::place::{instance_bounds, used_points};

/// Bounding boxes of instances, and hierarchies of the faces of their meshes.
pub struct NearFaces<'s> {
    scene: &'s Scene,
    placed: &'s PlacedInstances,
    /// By instance; empty without faces.
    boxes: Vec<Bounds>,
    /// A hierarchy of the boxes that are not empty, and the instance of each.
    tree: Bvh,
    instances: Vec<usize>,
    /// By mesh.
    faces: Vec<Option<Bvh>>,
}

/// Faces of two instances that may meet, by the ids of their meshes.
pub struct NearPair {
    pub faces: [Vec<FaceId>; 2],
    /// Number of faces that were looked at.
    pub visited: usize,
}

impl<'s> NearFaces<'s> {
    /// Builds the hierarchies; `None` if there are no faces.
    pub fn of(scene: &'s Scene, placed: &'s PlacedInstances) -> Option<Self> {
        let points = used_points(scene);
        let bounds = |own: &PlacedMesh| instance_bounds(&own.shown, &points[own.shown.mesh]);
        let boxes: Vec<Bounds> = placed.instances.par_iter().map(bounds).collect();
        let instances: Vec<usize> = (0..boxes.len()).filter(|&i| !boxes[i].is_empty()).collect();
        // Each box is stored as a degenerate face between two opposite corners.
        let corners = instances.iter().flat_map(|&i| [boxes[i].min, boxes[i].max]).collect();
        let face = |i: usize| [2 * i, 2 * i + 1, 2 * i + 1].map(VertexId::new);
        let tree = Bvh::new(&Mesh::new(corners, (0..instances.len()).map(face).collect())).ok()?;
        let faces = scene.meshes.par_iter().map(|mesh| Bvh::new(&mesh.mesh).ok()).collect();
        Some(Self { scene, placed, boxes, tree, instances, faces })
    }

    /// Returns the instances after one whose boxes meet its box, in order.
    pub fn after(&self, instance: usize) -> Vec<usize> {
        let own = self.boxes[instance];
        let mut found = Vec::new();
        if own.is_empty() {
            return found;
        }
        self.tree.faces_near_box([own.min, own.max], |face| {
            let other = self.instances[face.index()];
            if other > instance && meet(&own, &self.boxes[other]) {
                found.push(other);
            }
        });
        found.sort_unstable();
        found
    }

    /// Returns the faces of two instances that may meet. None that meets the other instance is left
    /// out, and at a point that both instances have, all faces of both are returned.
    pub fn pair(&self, [a, b]: [usize; 2]) -> NearPair {
        let (mut of_a, looked) = self.within(a, &self.boxes[b]);
        let (of_b, looked_too) = self.within(b, &self.hull(a, &of_a));
        let hull = self.hull(b, &of_b);
        of_a.retain(|face| meet(&self.face_bounds(a, *face), &hull));
        NearPair { faces: [of_a, of_b], visited: looked + looked_too }
    }

    /// Returns the faces of an instance whose bounding boxes meet a box, and how many were looked at.
    fn within(&self, instance: usize, reach: &Bounds) -> (Vec<FaceId>, usize) {
        let own = &self.placed.instances[instance];
        let (mut found, mut visited) = (Vec::new(), 0);
        let Some(tree) = &self.faces[own.shown.mesh] else { return (found, 0) };
        if reach.is_empty() {
            return (found, 0);
        }
        let local = self.in_mesh(instance, reach);
        tree.faces_near_box([local.min, local.max], |face| {
            visited += 1;
            if meet(&self.face_bounds(instance, face), reach) {
                found.push(face);
            }
        });
        (found, visited)
    }

    /// Moves a box from world space to the space of an instance's mesh, and returns the box around it
    /// there, a little larger than rounding needs.
    fn in_mesh(&self, instance: usize, of: &Bounds) -> Bounds {
        let world = DMat4::from_cols_array_2d(&self.placed.instances[instance].shown.transform);
        let own = &self.boxes[instance];
        let [min, max, low, high] = [of.min, of.max, own.min, own.max].map(DVec3::from);
        let (min, max) = (min.max(low), max.min(high));
        let reach = low.abs().max(high.abs()).max(world.w_axis.truncate().abs()).max_element();
        let slack = DVec3::splat(ROUNDING * reach);
        let (min, max, back) = (min - slack, max + slack, world.inverse());
        let mut bounds = Bounds::EMPTY;
        for corner in 0..8 {
            let side = |axis: usize| if corner >> axis & 1 == 0 { min[axis] } else { max[axis] };
            let at = DVec3::new(side(0), side(1), side(2));
            bounds.add(back.transform_point3(at).to_array());
        }
        bounds
    }

    /// Returns the box of some faces of an instance.
    fn hull(&self, instance: usize, faces: &[FaceId]) -> Bounds {
        let mut hull = Bounds::EMPTY;
        faces.iter().for_each(|face| hull.merge(&self.face_bounds(instance, *face)));
        hull
    }

    fn face_bounds(&self, instance: usize, face: FaceId) -> Bounds {
        let own = &self.placed.instances[instance];
        let mesh = &self.scene.meshes[own.shown.mesh].mesh;
        Bounds::of(&mesh.faces[face.index()].map(|v| own.point(mesh.positions[v.index()])))
    }
}

/// Greatest rounding error of a place that is moved to the space of a mesh and back, relative to its
/// coordinates.
const ROUNDING: f64 = 1e-12;

/// Returns true if two boxes have a point in common.
fn meet(a: &Bounds, b: &Bounds) -> bool {
    (0..3).all(|axis| a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis])
}
