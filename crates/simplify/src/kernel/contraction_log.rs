//! What the fast engine has done, in order, and how it is shown to those who want to see the surface.
//!
//! The engine has no faces. So its contractions are made again on a surface that has: without costs or
//! checks, all of which is decided.

use glam::Vec3;
use meshlod_mesh::{FaceId, Mesh, VertexId};

use crate::engine::policy::Observe;
use crate::kernel::attributes::RecordedValues;
use crate::kernel::components::Component;
use crate::kernel::mesh::local_frame::Frame;
use crate::kernel::mesh::one_ring::VertexStore;
use crate::kernel::setup::vertex_order::Order;
use crate::surface::contracted::Freedom;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Placed, Surface};

/// A contraction as it is taken down: 28 bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoggedContraction {
    pub(crate) kept: u32,
    pub(crate) gone: u32,
    /// Where the kept one is after it.
    pub(crate) place: Vec3,
    /// The square of how far the surface has moved there.
    pub(crate) moved: f32,
    /// The bucket that it came from.
    pub(crate) front: u16,
}

/// A step as it is taken down.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Logged {
    Contraction(LoggedContraction),
    /// The component of this number among those that have vanished.
    Vanished(usize),
}

/// From the engine's ids and places to the input's.
#[derive(Clone, Copy)]
pub(crate) struct InputNames<'w> {
    pub(crate) mesh: &'w Mesh,
    pub(crate) frame: &'w Frame,
    pub(crate) order: &'w Order,
    pub(crate) store: &'w VertexStore,
}

impl InputNames<'_> {
    /// The vertex of the input that one is, or is a copy of.
    #[inline]
    pub(crate) fn input(&self, v: u32) -> VertexId {
        VertexId(self.order.input(self.store.origin(v)))
    }

    /// The position of a vertex of the input at a place.
    #[inline]
    pub(crate) fn position(&self, input: VertexId, place: Vec3) -> [f64; 3] {
        self.frame.to_model_or_input(self.mesh.positions[input.index()], place)
    }
}

/// What parts have done side by side as if one had: by cost, each part in its order.
pub(crate) fn merge(logs: impl Iterator<Item = Vec<Logged>>) -> Vec<Logged> {
    let mut merged: Vec<(u16, Logged)> = Vec::new();
    for log in logs {
        let mut front = 0;
        merged.extend(log.into_iter().map(|done| {
            if let Logged::Contraction(done) = &done {
                front = front.max(done.front);
            }
            (front, done)
        }));
    }
    merged.sort_by_key(|&(front, _)| front);
    merged.into_iter().map(|(_, done)| done).collect()
}

/// Makes contractions again on a surface, before the eyes of the observer.
pub(crate) fn replay(
    (log, values): (&[Logged], &[RecordedValues]),
    components: &[Component],
    names: InputNames<'_>,
    surface: &mut Surface,
    observer: &mut dyn Observe,
) {
    let mut edge_ring = Neighbourhood::default();
    let mut values = values.iter().peekable();
    for (number, done) in log.iter().enumerate() {
        let done = match done {
            Logged::Contraction(done) => done,
            Logged::Vanished(component) => {
                vanish(&components[*component], names, surface, observer);
                continue;
            }
        };
        let [kept, gone] = [done.kept, done.gone].map(|v| names.input(v));
        let position = names.position(kept, done.place).into();
        let stays = position == surface.position(kept);
        let freedom = if stays { Freedom::At(0) } else { Freedom::Free };
        edge_ring.gather_decided(surface, [kept, gone], freedom);
        let error_estimate = f64::from(done.moved).sqrt() * names.frame.unit;
        let placed = Placed { position, kept: 0, error_estimate };
        observer.before(surface, &edge_ring, &placed);
        surface.contract(&edge_ring, &placed);
        // The engine's values, not those of the surface's own making.
        while let Some(next) = values.next_if(|next| next.number == number) {
            surface.wedges.iter_mut().for_each(|all| all.restore(next.wedge, &next.values));
        }
        observer.after(surface, &edge_ring, &placed);
    }
}

/// Takes a component out of a surface, before the eyes of the observer.
fn vanish(
    component: &Component,
    names: InputNames<'_>,
    surface: &mut Surface,
    observer: &mut dyn Observe,
) {
    let inputs = component.vertices.iter().map(|&v| names.input(v));
    let mut faces: Vec<FaceId> = inputs.flat_map(|v| surface.star(v).collect::<Vec<_>>()).collect();
    faces.sort_unstable();
    faces.dedup();
    faces.retain(|&face| surface.is_alive(face));
    observer.vanish(surface, &faces);
    surface.take_out(&faces);
}
