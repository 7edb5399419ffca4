//! Components that vanish as a whole once that is the cheapest step.

use glam::{DVec3, Vec3};

use crate::kernel::attributes::AttributeModel;
use crate::kernel::collapse_loop::CollapseLoop;
use crate::kernel::components::Component;
use crate::kernel::contraction_log::Logged;
use crate::kernel::mesh::one_ring::GHOST;
use crate::kernel::mesh::vertex::VertexFlags;
use crate::kernel::schedule::bucket_queue::NONE;
use crate::refusal::Refusal;

impl<A: AttributeModel> CollapseLoop<'_, A> {
    /// Removes the cheapest component if its bucket is at most `last`. Returns false if there is
    /// none.
    #[cold]
    pub(crate) fn vanish_up_to(&mut self, last: u16) -> bool {
        while let Some(component) = self.components.as_mut().and_then(|all| all.take_up_to(last)) {
            let faces = self.faces_of(&component);
            if faces.len() >= self.live_faces {
                self.refusals.add(Refusal::LastFaces);
            } else if self.within.as_ref().is_some_and(|bound| component.size > bound.max_error()) {
                self.refusals.add(Refusal::Error);
                self.components.iter_mut().for_each(|all| all.refused.push(component.clone()));
            } else {
                self.vanish(component, &faces);
                return true;
            }
        }
        false
    }

    /// Returns the faces that are left of a component.
    fn faces_of(&mut self, component: &Component) -> Vec<[u32; 3]> {
        let mut faces = Vec::new();
        for &v in &component.vertices {
            if self.vertices.get(v).flags.any(VertexFlags::DEAD) {
                continue;
            }
            self.vertices.refresh(v);
            let ring = self.vertices.neighbours(v);
            for (&a, &b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                if v < a && v < b && a != GHOST && b != GHOST {
                    faces.push([v, a, b]);
                }
            }
        }
        faces
    }

    /// Merges all vertices of a component into one without faces.
    fn vanish(&mut self, component: Component, faces: &[[u32; 3]]) {
        let live = |v: &u32| !self.vertices.get(*v).flags.any(VertexFlags::DEAD);
        let left: Vec<u32> = component.vertices.iter().copied().filter(live).collect();
        self.count_volume(&left, faces);
        self.live_faces -= faces.len();
        self.error = self.error.max(f64::from(component.size).powi(2));
        for &v in &left {
            let vertex = self.vertices.get_mut(v);
            vertex.bucket = NONE;
            vertex.len = 0;
            if v == left[0] {
                vertex.flags.set(VertexFlags::BARRED);
            } else {
                vertex.flags.set(VertexFlags::DEAD);
                vertex.target = left[0];
            }
        }
        let Some(components) = &mut self.components else { return };
        if let Some(log) = &mut self.log {
            log.push(Logged::Vanished(components.vanished.len()));
            self.model.skip_record();
        }
        components.vanished.push(component);
    }

    fn count_volume(&mut self, left: &[u32], faces: &[[u32; 3]]) {
        let place = |v: u32| self.vertices.get(v).place();
        let is_open = left.iter().any(|&v| self.vertices.neighbours(v).contains(&GHOST));
        let origin: DVec3 = left.first().map_or(Vec3::ZERO, |&v| place(v)).into();
        let sixfold = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|v| place(v).as_dvec3() - origin);
            a.cross(b).dot(c)
        };
        let sixfold = faces.iter().map(sixfold).sum();
        let places: Vec<Vec3> = left.iter().map(|&v| place(v)).collect();
        self.volume.add_component(&places, sixfold, is_open);
    }
}
