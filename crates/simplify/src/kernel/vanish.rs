//! Components that vanish as a whole once that is the cheapest step.

use glam::{DVec3, Vec3};

use crate::kernel::attributes::AttributeModel;
use crate::kernel::collapse_loop::{CollapseLoop, is_out_of_proportion, is_seen};
use crate::kernel::components::{VanishingCost, faces_at};
use crate::kernel::contraction_log::Logged;
use crate::kernel::mesh::one_ring::GHOST;
use crate::kernel::mesh::vertex::VertexFlags;
use crate::kernel::schedule::bucket_queue::{NONE, last_bucket};
use crate::refusal::Refusal;

/// Number of buckets after which a component is tried again that was out of proportion.
const LATER: u16 = 8;

/// Number of faces up to which a component may be most of what is left and yet vanish.
const FEW: usize = 64;

/// Returns true if a component with this many of all faces is most of what is left.
fn is_most(faces: usize, all: usize) -> bool {
    faces > FEW && 2 * faces > all
}

impl<A: AttributeModel> CollapseLoop<'_, A> {
    /// Removes the cheapest component if its bucket is at most `last`, unless it is refused or has
    /// become more expensive.
    ///
    /// Costs only rise, as a component loses faces and as others vanish. So a cost found earlier is
    /// a lower bound, and is computed again when its turn comes.
    #[cold]
    pub(crate) fn vanish_up_to(&mut self, last: u16) {
        if let Some(components) = &mut self.components {
            components.count(&mut self.vertices);
        }
        while let Some(component) = self.components.as_mut().and_then(|all| all.take_up_to(last)) {
            let Some(components) = &mut self.components else { return };
            let left = components.faces_left(component);
            if left == 0 {
                continue;
            }
            let (cost, apart) = match components.cost::<A::Metric>(component, last) {
                VanishingCost::Exactly(bucket, apart) => (bucket, apart),
                VanishingCost::AtLeast(bucket) => {
                    components.put_back(component, bucket);
                    continue;
                }
            };
            let loss = components.loss(component, &apart);
            if cost > last {
                components.put_back(component, cost);
                continue;
            }
            if let Some(later) = self.deferral.delay(loss, cost).filter(|&later| later > last) {
                components.put_back(component, later);
                continue;
            }
            let max_error = self
                .within
                .as_ref()
                .map_or(f32::INFINITY, |bound| bound.limit_at(components.vertices(component)));
            if left >= self.live_faces {
                self.refusals.add(Refusal::LastFaces);
            } else if is_out_of_proportion(loss, self.error as f32, self.room)
                || is_most(left, self.live_faces) && is_seen(loss, self.room)
            {
                self.refusals.add(Refusal::Disproportion);
                // By then the surface may have moved as far elsewhere.
                match last.min(last_bucket()).saturating_add(LATER) {
                    later if later < last_bucket() => components.put_back(component, later),
                    _ => components.refuse(component),
                }
            } else if apart.greatest > max_error * max_error {
                components.refuse(component);
                self.refusals.add(Refusal::Error);
            } else {
                components.remove(component);
                self.error = self.error.max(apart.greatest.into());
                let faces = self.faces_of(component);
                return self.vanish(component, &faces);
            }
        }
    }

    /// Returns the vertices that are left of a component.
    fn left_of(&self, component: u32) -> Vec<u32> {
        let Some(components) = &self.components else { return Vec::new() };
        let of_input = components.vertices(component);
        let is_live = |v: &u32| !self.vertices.get(*v).flags.any(VertexFlags::DEAD);
        let cuts = self.handles.iter().flat_map(|handles| handles.copies());
        let of_cuts = cuts.filter(|&v| components.has(component, v));
        of_input.iter().copied().chain(of_cuts).filter(is_live).collect()
    }

    /// Returns the faces that are left of a component.
    pub(crate) fn faces_of(&mut self, component: u32) -> Vec<[u32; 3]> {
        let mut faces = Vec::new();
        for v in self.left_of(component) {
            self.vertices.refresh(v);
            faces_at(&self.vertices, v, &mut faces);
        }
        faces
    }

    /// Merges all vertices of a component into one without faces.
    pub(crate) fn vanish(&mut self, component: u32, faces: &[[u32; 3]]) {
        let left = self.left_of(component);
        let owed = self.debts.take(left.iter().map(|&v| self.vertices.slot(v)));
        self.count_volume(&left, faces, owed);
        self.live_faces -= faces.len();
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
        if let Some(log) = &mut self.log {
            log.push(Logged::Vanished(component));
            self.model.skip_record();
        }
    }

    /// Counts the volume of a component that vanishes. What it owes is no loss of those that stay.
    fn count_volume(&mut self, left: &[u32], faces: &[[u32; 3]], owed: f64) {
        let place = |v: u32| self.vertices.get(v).place();
        let is_open = left.iter().any(|&v| self.vertices.neighbours(v).contains(&GHOST));
        let origin: DVec3 = left.first().map_or(Vec3::ZERO, |&v| place(v)).into();
        let sixfold = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|v| place(v).as_dvec3() - origin);
            a.cross(b).dot(c)
        };
        let sixfold = faces.iter().map(sixfold).sum::<f64>();
        let places: Vec<Vec3> = left.iter().map(|&v| place(v)).collect();
        self.volume.add_component(&places, [sixfold, owed], is_open);
    }
}
