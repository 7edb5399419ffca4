//! Log of the contractions made by the kernel, and its replay for observers.
//!
//! The kernel has no faces. For observers its contractions are repeated on a surface that has them,
//! without costs and checks, as everything is decided.

use glam::Vec3;
use meshlod_mesh::{FaceId, Mesh, VertexId};

use crate::engine::policy::Observe;
use crate::kernel::attributes::RecordedValues;
use crate::kernel::components::Components;
use crate::kernel::mesh::local_frame::Frame;
use crate::kernel::mesh::one_ring::VertexStore;
use crate::kernel::setup::vertex_order::Order;
use crate::surface::contracted::Freedom;
use crate::surface::neighbourhood::Neighbourhood;
use crate::surface::{Placed, Surface};

/// A contraction in the log: 28 bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LoggedContraction {
    pub(crate) kept: u32,
    pub(crate) gone: u32,
    /// Position of the remaining vertex after the contraction, in the frame.
    pub(crate) place: Vec3,
    /// Square of the distance that the surface has moved at that vertex.
    pub(crate) moved: f32,
    /// Bucket that the contraction was taken from.
    pub(crate) front: u16,
}

/// A step in the log: a contraction, or the removal of a component.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Logged {
    Contraction(LoggedContraction),
    /// Number of the component that was removed as a whole.
    Vanished(u32),
}

/// Correspondence between the kernel's ids and places and those of the input.
#[derive(Clone, Copy)]
pub(crate) struct InputNames<'w> {
    pub(crate) mesh: &'w Mesh,
    pub(crate) frame: &'w Frame,
    pub(crate) order: &'w Order,
    pub(crate) store: &'w VertexStore,
    /// Number of vertices of the input, without copies.
    pub(crate) own: usize,
}

impl InputNames<'_> {
    /// Returns the input vertex that `v` is, or is a copy of. Vertices of cuts come after those of
    /// the input.
    #[inline]
    pub(crate) fn input(&self, v: u32) -> VertexId {
        let InputNames { mesh, order, store, own, .. } = self;
        match (v as usize).checked_sub(*own) {
            Some(spare) if store.spare > 0 => VertexId::new(mesh.positions.len() + spare),
            Some(copy) => VertexId(order.input(store.copied[copy])),
            None => VertexId(order.input(v)),
        }
    }

    /// Returns the number of vertices of the input and of those for cuts.
    pub(crate) fn count(&self) -> usize {
        self.mesh.positions.len() + self.store.spare
    }

    /// Returns the position in model units of an input vertex at a place.
    #[inline]
    pub(crate) fn position(&self, input: VertexId, place: Vec3) -> [f64; 3] {
        match self.mesh.positions.get(input.index()) {
            Some(&position) => self.frame.to_model_or_input(position, place),
            None => self.frame.to_model(place),
        }
    }
}

/// Steps, and the values that they have given to attributes, by the indices of the steps.
#[derive(Default)]
pub(crate) struct Steps {
    pub(crate) log: Vec<Logged>,
    pub(crate) values: Vec<RecordedValues>,
}

impl Steps {
    /// Appends the steps of parts that ran side by side: by cost, each part in its own order.
    pub(crate) fn append(&mut self, parts: impl Iterator<Item = Steps>) {
        let (mut merged, mut values) = (Vec::new(), Vec::new());
        for (part, steps) in parts.enumerate() {
            let mut front = 0;
            merged.extend(steps.log.into_iter().map(|done| {
                if let Logged::Contraction(done) = &done {
                    front = front.max(done.front);
                }
                (front, part as u32, done)
            }));
            values.push((0, steps.values.into_iter().peekable()));
        }
        merged.sort_by_key(|&(front, ..)| front);
        self.log.reserve(merged.len());
        for (_, part, done) in merged {
            let (number, values) = &mut values[part as usize];
            while let Some(next) = values.next_if(|next| next.number == *number) {
                self.values.push(RecordedValues { number: self.log.len(), ..next });
            }
            *number += 1;
            self.log.push(done);
        }
    }
}

/// Repeats logged contractions on a surface and shows them to an observer.
pub(crate) fn replay(
    (log, values): (&[Logged], &[RecordedValues]),
    components: Option<&Components>,
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
                let vertices = components.map_or(&[][..], |all| all.vertices(*component));
                vanish(vertices, names, surface, observer);
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
        // The surface has left the values of wedges to the kernel.
        while let Some(next) = values.next_if(|next| next.number == number) {
            surface.wedges.iter_mut().for_each(|all| all.restore(next.wedge, &next.values));
        }
        observer.after(surface, &edge_ring, &placed);
    }
}

/// Removes a component from a surface and shows it to the observer.
fn vanish(
    vertices: &[u32],
    names: InputNames<'_>,
    surface: &mut Surface,
    observer: &mut dyn Observe,
) {
    let inputs = vertices.iter().map(|&v| names.input(v));
    let mut faces: Vec<FaceId> = inputs.flat_map(|v| surface.star(v).collect::<Vec<_>>()).collect();
    faces.sort_unstable();
    faces.dedup();
    faces.retain(|&face| surface.is_alive(face));
    observer.vanish(surface, &faces);
    surface.take_out(&faces);
}
