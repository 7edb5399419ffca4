//! What the fast engine has done, in order, and how it is shown to those who want to see the surface.
//!
//! The engine has no faces. So its contractions are made again on a surface that has: without costs or
//! checks, all of which is decided.

use glam::Vec3;
use meshlod_mesh::{Mesh, VertexId};

use crate::contracted::Freedom;
use crate::fast::frame::Frame;
use crate::fast::looks::Revalued;
use crate::fast::order::Order;
use crate::fast::ring::Store;
use crate::neighbourhood::Neighbourhood;
use crate::policy::Observe;
use crate::surface::{Placed, Surface};

/// A contraction as it is taken down: 28 bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Done {
    pub(super) kept: u32,
    pub(super) gone: u32,
    /// Where the kept one is after it.
    pub(super) place: Vec3,
    /// The square of how far the surface has moved there.
    pub(super) moved: f32,
    /// The bucket that it came from.
    pub(super) front: u16,
}

/// From the engine's ids and places to the input's.
#[derive(Clone, Copy)]
pub(super) struct Names<'w> {
    pub(super) mesh: &'w Mesh,
    pub(super) frame: &'w Frame,
    pub(super) order: &'w Order,
    pub(super) store: &'w Store,
}

impl Names<'_> {
    /// The vertex of the input that one is, or is a copy of.
    #[inline]
    pub(super) fn input(&self, v: u32) -> VertexId {
        VertexId(self.order.input(self.store.origin(v)))
    }

    /// The position of a vertex of the input at a place.
    #[inline]
    pub(super) fn position(&self, input: VertexId, place: Vec3) -> [f64; 3] {
        self.frame.leave_from(self.mesh.positions[input.index()], place)
    }
}

/// What parts have done side by side as if one had: by cost, each part in its order.
pub(super) fn merge(logs: impl Iterator<Item = Vec<Done>>) -> Vec<Done> {
    let mut merged: Vec<(u16, Done)> = Vec::new();
    for log in logs {
        let mut front = 0;
        merged.extend(log.into_iter().map(|done| {
            front = front.max(done.front);
            (front, done)
        }));
    }
    merged.sort_by_key(|&(front, _)| front);
    merged.into_iter().map(|(_, done)| done).collect()
}

/// Makes contractions again on a surface, before the eyes of the observer.
pub(super) fn replay(
    log: &[Done],
    values: &[Revalued],
    names: Names<'_>,
    surface: &mut Surface,
    observer: &mut dyn Observe,
) {
    let mut hood = Neighbourhood::default();
    let mut values = values.iter().peekable();
    for (number, done) in log.iter().enumerate() {
        let [kept, gone] = [done.kept, done.gone].map(|v| names.input(v));
        let position = names.position(kept, done.place).into();
        let stays = position == surface.position(kept);
        let freedom = if stays { Freedom::At(0) } else { Freedom::Free };
        hood.gather_decided(surface, [kept, gone], freedom);
        let error_estimate = f64::from(done.moved).sqrt() * names.frame.unit;
        let placed = Placed { position, kept: 0, error_estimate };
        observer.before(surface, &hood, &placed);
        surface.contract(&hood, &placed);
        // The engine's values, not those of the surface's own making.
        while let Some(next) = values.next_if(|next| next.number == number) {
            surface.wedges.iter_mut().for_each(|all| all.restore(next.wedge, &next.values));
        }
        observer.after(surface, &hood, &placed);
    }
}
