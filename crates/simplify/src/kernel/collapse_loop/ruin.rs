//! Steps that would ruin the shape, and are refused.

use glam::Vec3;
use meshlod_mesh::UnionFind;

use crate::kernel::mesh::one_ring::{GHOST, Vertices};
use crate::kernel::mesh::vertex::VertexFlags;
use crate::kernel::schedule::bucket_queue::NONE;

/// Fraction of the diagonal by which a single step may always move the surface.
const RUIN: f32 = 1.0 / 3.0;

/// Multiple of the largest distance so far by which a single step may always move the surface.
const LEAP: f32 = 3.0;

/// Fraction of the diagonal by which a single step may move the surface at any price.
const SEEN: f32 = 0.02;

/// Returns true if a step would ruin the model: it moves the surface by this squared distance, and
/// the largest so far is `largest`. Half the model's box has the size `room`.
#[inline(always)]
pub(crate) fn is_out_of_proportion(now: f32, largest: f32, room: Vec3) -> bool {
    now > RUIN * RUIN * 4.0 * room.length_squared() && now > LEAP * LEAP * largest
}

/// Returns true if a step that moves the surface by this squared distance changes the shape as a
/// whole.
#[inline(always)]
pub(crate) fn is_seen(now: f32, room: Vec3) -> bool {
    now > SEEN * SEEN * 4.0 * room.length_squared()
}

/// Returns true if the surface is in several components, and more than half of its vertices can go
/// no further.
pub(crate) fn are_parts_stuck(vertices: &mut Vertices<'_>) -> bool {
    let (mut live, mut stuck, mut joins) = (0, 0, 0);
    let mut joined = UnionFind::new(vertices.all.len());
    for v in vertices.ids() {
        let vertex = vertices.get(v);
        if vertex.len == 0 || vertex.flags.any(VertexFlags::DEAD) {
            continue;
        }
        live += 1;
        stuck += usize::from(vertex.bucket == NONE);
        vertices.refresh(v);
        for &w in vertices.neighbours(v) {
            let slots = [v, w].map(|v| vertices.slot(v));
            let is_here = w != GHOST && slots[1] < vertices.all.len();
            joins += usize::from(is_here && joined.union(slots[0] as u32, slots[1] as u32));
        }
    }
    live > joins + 1 && 2 * stuck > live
}
