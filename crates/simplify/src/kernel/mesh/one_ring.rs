//! One-rings: up to sixteen neighbours in the vertex itself, longer rings in a list beside.
//!
//! A ring in the vertex is kept up to date by every contraction. A list is not: neighbours that
//! have been contracted are replaced when the list is next read, so a hub of a hundred thousand
//! faces costs its neighbours nothing.

use std::ops::Range;

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use crate::kernel::mesh::vertex::{Bf16, NO_VERTEX, RING, Vertex, VertexFlags, VertexQuadric};

/// Value of [`Vertex::len`] for a ring in a list. The first number of `ring` is then the index of
/// the list, the second its length.
pub(crate) const LONG: u8 = u8::MAX;

/// Longest ring that a contraction may create. A vertex with a longer one waits until its
/// neighbours have become fewer. The cost of a contraction grows with the square of this.
pub(crate) const MAX_RING: usize = 64;

/// Vertex that closes the rings of boundary vertices. It has no record of its own.
pub(crate) const GHOST: u32 = u32::MAX - 1;

/// Record read in place of the ghost and of vertices in other parts: their edges are not
/// contracted.
static ELSEWHERE: Vertex = Vertex {
    quadric: VertexQuadric([Vec4::ZERO; 3]),
    target: NO_VERTEX,
    moved: 0.0,
    bucket: 0,
    floor: 0,
    flags: VertexFlags::BARRED,
    len: 0,
    constant: Bf16::NONE,
    ring: [NO_VERTEX; RING],
};

/// All vertices, dead ones included, and the rings too long for them.
pub(crate) struct VertexStore {
    pub(crate) all: Vec<Vertex>,
    pub(crate) long: Vec<LongRing>,
    /// Originals of the copies, which are the last vertices.
    pub(crate) copied: Vec<u32>,
    /// Vertices that have copies, sorted.
    pub(crate) split: Vec<u32>,
    /// Number of vertices at the end that the input does not have: they are for cuts. Then there
    /// are no copies.
    pub(crate) spare: usize,
    /// Weight of boundary edges.
    pub(crate) boundary_weight: f32,
    /// Factor on the cost of an edge at a protected vertex.
    pub(crate) protection: f32,
}

/// A ring in a list. Its vertex may have a ring elsewhere by now.
pub(crate) struct LongRing {
    pub(crate) of: u32,
    ring: Vec<u32>,
}

/// A range of the vertices. Vertices outside the range are known by their ids only.
pub(crate) struct Vertices<'v> {
    pub(crate) all: &'v mut [Vertex],
    /// Id of the first vertex.
    pub(crate) base: u32,
    pub(crate) long: &'v mut Vec<LongRing>,
    /// Originals of the copies, which are the vertices from `first_copy` on.
    pub(crate) copied: &'v [u32],
    pub(crate) split: &'v [u32],
    pub(crate) first_copy: u32,
    /// Factor on the cost of an edge at a protected vertex.
    pub(crate) protection: f32,
}

impl VertexStore {
    pub(crate) fn new(
        mut all: Vec<Vertex>,
        copied: Vec<u32>,
        lists: Vec<Vec<LongRing>>,
        boundary_weight: f32,
    ) -> Self {
        let mut long = Vec::new();
        let mut vertices = Vertices::new(&mut all, 0, &mut long);
        lists.into_iter().for_each(|lists| vertices.adopt(lists));
        let mut split = copied.clone();
        split.sort_unstable();
        split.dedup();
        Self { all, long, copied, split, spare: 0, boundary_weight, protection: 1.0 }
    }

    /// Borrows the whole surface: all vertices.
    pub(crate) fn whole(&mut self) -> Vertices<'_> {
        let first_copy = self.first_copy();
        let Self { all, long, copied, split, protection, .. } = self;
        Vertices { all, base: 0, long, copied, split, first_copy, protection: *protection }
    }

    /// Returns the number of vertices of the input, without copies.
    pub(crate) fn own(&self) -> usize {
        self.all.len() - self.copied.len() - self.spare
    }

    /// Returns the id of the first copy; that of no vertex if there are none.
    pub(crate) fn first_copy(&self) -> u32 {
        (self.all.len() - self.copied.len()) as u32
    }

    /// Appends vertices for cuts. There must be no copies.
    pub(crate) fn add_spare(&mut self, count: usize) {
        let mut vertex = Vertex::at(Vec3::ZERO);
        vertex.flags.set(VertexFlags::BARRED);
        self.all.resize(self.all.len() + count, vertex);
        self.spare += count;
    }

    /// Returns the input vertex that `v` is, or is a copy of.
    pub(crate) fn origin(&self, v: u32) -> u32 {
        (v as usize).checked_sub(self.own()).map_or(v, |copy| self.copied[copy])
    }

    /// Returns for each vertex the live vertex that it is or has been contracted into.
    pub(crate) fn live_vertices(&self) -> Vec<u32> {
        let next = |(v, vertex): (usize, &Vertex)| match vertex.flags.any(VertexFlags::DEAD) {
            true => vertex.target,
            false => v as u32,
        };
        let mut live: Vec<u32> = self.all.par_iter().enumerate().map(next).collect();
        for v in 0..live.len() {
            let mut last = live[v];
            while live[last as usize] != last {
                last = live[last as usize];
            }
            let mut at = v;
            while live[at] != last {
                at = std::mem::replace(&mut live[at], last) as usize;
            }
        }
        live
    }
}

impl<'v> Vertices<'v> {
    /// Borrows vertices, assuming that none is a copy.
    pub(crate) fn new(all: &'v mut [Vertex], base: u32, long: &'v mut Vec<LongRing>) -> Self {
        Self { all, base, long, copied: &[], split: &[], first_copy: GHOST, protection: 1.0 }
    }

    /// Returns the range of vertex ids.
    pub(crate) fn ids(&self) -> Range<u32> {
        self.base..self.base + self.all.len() as u32
    }

    /// Returns the ids of the copies.
    pub(crate) fn copies(&self) -> Range<u32> {
        let end = self.all.len() as u32;
        self.first_copy.min(end)..end
    }

    /// Returns the index of a vertex in its part.
    #[inline(always)]
    pub(crate) fn slot(&self, v: u32) -> usize {
        v.wrapping_sub(self.base) as usize
    }

    /// Takes over the long rings of a part.
    pub(crate) fn adopt(&mut self, lists: Vec<LongRing>) {
        for (slot, list) in lists.into_iter().enumerate() {
            let next = self.long.len() as u32;
            let vertex = self.get_mut(list.of);
            if vertex.len == LONG && vertex.ring[0] == slot as u32 {
                vertex.ring[0] = next;
                self.long.push(list);
            }
        }
    }

    /// Returns a vertex. The ghost and vertices of other parts read as one that is barred.
    #[inline(always)]
    pub(crate) fn get(&self, v: u32) -> &Vertex {
        self.all.get(self.slot(v)).unwrap_or(&ELSEWHERE)
    }

    /// Returns a vertex of this part for writing.
    #[inline(always)]
    pub(crate) fn get_mut(&mut self, v: u32) -> &mut Vertex {
        let slot = self.slot(v);
        &mut self.all[slot]
    }

    /// Returns the input vertex that `v` is, or is a copy of.
    #[inline]
    pub(crate) fn origin(&self, v: u32) -> u32 {
        if v < self.first_copy || v == GHOST {
            return v;
        }
        self.copied[(v - self.first_copy) as usize]
    }

    /// Returns true if `v` is one of several copies of a non-manifold vertex.
    pub(crate) fn is_split(&self, v: u32) -> bool {
        (v >= self.first_copy && v != GHOST) || self.split.binary_search(&v).is_ok()
    }

    /// Returns the live vertex that `v` is or has been contracted into, and shortens the path to
    /// it.
    pub(crate) fn live_vertex(&mut self, mut v: u32) -> u32 {
        while self.get(v).flags.any(VertexFlags::DEAD) {
            let next = self.get(v).target;
            let beyond = *self.get(next);
            if beyond.flags.any(VertexFlags::DEAD) {
                self.get_mut(v).target = beyond.target;
            }
            v = next;
        }
        v
    }

    /// Brings the ring of a vertex up to date.
    #[inline(always)]
    pub(crate) fn refresh(&mut self, v: u32) {
        if self.get(v).len == LONG {
            self.refresh_long(v);
        }
    }

    /// Returns the neighbours of a vertex, counter-clockwise, as last brought up to date.
    #[inline(always)]
    pub(crate) fn neighbours(&self, v: u32) -> &[u32] {
        let vertex = self.get(v);
        match vertex.len {
            LONG => &self.long[vertex.ring[0] as usize].ring,
            len => &vertex.ring[..len as usize],
        }
    }

    /// Replaces a neighbour in the ring of a vertex by another.
    pub(crate) fn replace_neighbour(&mut self, v: u32, gone: u32, kept: u32) {
        self.refresh(v);
        let vertex = self.get_mut(v);
        if vertex.len != LONG {
            return vertex.replace_neighbour(gone, kept);
        }
        let slot = vertex.ring[0] as usize;
        self.long[slot].ring.iter_mut().for_each(|w| *w = if *w == gone { kept } else { *w });
    }

    /// Replaces contracted neighbours in a long ring by their live vertices.
    #[cold]
    fn refresh_long(&mut self, v: u32) {
        let slot = self.get(v).ring[0] as usize;
        let mut list = std::mem::take(&mut self.long[slot].ring);
        list.iter_mut().for_each(|w| *w = self.live_vertex(*w));
        list.dedup();
        while list.len() > 1 && list.first() == list.last() {
            list.pop();
        }
        self.get_mut(v).ring[1] = list.len() as u32;
        if list.len() <= RING {
            return self.set_ring(v, &list);
        }
        self.long[slot].ring = list;
    }

    /// Sets the ring of a vertex to the first `len` of these ids.
    #[inline(always)]
    pub(crate) fn set_ring_of<const N: usize>(&mut self, v: u32, ring: &[u32; N], len: usize) {
        if len > RING {
            return self.set_long(v, &ring[..len]);
        }
        let vertex = self.get_mut(v);
        // Copy the whole array: a copy of variable length is a call.
        vertex.ring.copy_from_slice(&ring[..RING]);
        vertex.len = len as u8;
    }

    /// Sets the ring of a vertex.
    #[inline(always)]
    pub(crate) fn set_ring(&mut self, v: u32, ring: &[u32]) {
        if ring.len() > RING {
            return self.set_long(v, ring);
        }
        let vertex = self.get_mut(v);
        vertex.ring[..ring.len()].copy_from_slice(ring);
        vertex.len = ring.len() as u8;
    }

    #[cold]
    fn set_long(&mut self, v: u32, ring: &[u32]) {
        let slot = match self.get(v) {
            Vertex { len: LONG, ring: [slot, ..], .. } => *slot as usize,
            _ => {
                self.long.push(LongRing { of: v, ring: Vec::new() });
                self.long.len() - 1
            }
        };
        self.long[slot].ring = ring.to_vec();
        let vertex = self.get_mut(v);
        vertex.len = LONG;
        vertex.ring[..2].copy_from_slice(&[slot as u32, ring.len() as u32]);
        if ring.len() > MAX_RING {
            vertex.flags.set(VertexFlags::BARRED);
        }
    }
}

impl Vertex {
    /// Removes a neighbour from the vertex's ring. Returns true if the vertex was a hub and no
    /// longer is.
    #[inline(always)]
    pub(crate) fn remove_neighbour(&mut self, neighbour: u32) -> bool {
        if self.len == LONG {
            self.ring[1] = self.ring[1].saturating_sub(1);
            let shrunk = self.flags.any(VertexFlags::BARRED) && self.ring[1] as usize <= MAX_RING;
            if shrunk {
                self.flags.clear(VertexFlags::BARRED);
            }
            return shrunk;
        }
        let len = self.len as usize;
        if let Some(at) = index_in_ring(&self.ring, len, neighbour) {
            // Move the whole array: a move of variable length is a call.
            for i in 0..RING - 1 {
                let (here, next) = (self.ring[i], self.ring[i + 1]);
                self.ring[i] = if (i as u32) < at as u32 { here } else { next };
            }
            self.len -= 1;
        }
        false
    }

    /// Replaces a neighbour in the vertex's ring by another.
    #[inline(always)]
    pub(crate) fn replace_neighbour(&mut self, gone: u32, kept: u32) {
        if self.len != LONG {
            for w in &mut self.ring {
                *w = if *w == gone { kept } else { *w };
            }
        }
    }
}

/// Returns the index of `v` among the first `len` ids of a ring, without a branch.
#[inline(always)]
pub(crate) fn index_in_ring(ring: &[u32; RING], len: usize, v: u32) -> Option<usize> {
    let mut at = 0;
    for (i, &w) in (0..).zip(ring) {
        at |= if w == v { 1 << i } else { 0 };
    }
    let at = at & ((1_u32 << len) - 1);
    (at != 0).then(|| at.trailing_zeros() as usize % RING)
}

/// Returns the index of `v` in a ring.
#[inline(always)]
pub(crate) fn index_in(ring: &[u32], v: u32) -> Option<usize> {
    ring.iter().position(|&w| w == v)
}

/// Returns true if a vertex lies on a seam.
#[inline(always)]
pub(crate) fn is_seam(vertices: &Vertices, v: u32) -> bool {
    vertices.get(v).flags.any(VertexFlags::SEAM)
}
