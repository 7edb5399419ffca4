//! Rings: sixteen neighbours in the vertex itself, more of them in a list beside.
//!
//! A ring in the vertex is kept up by every contraction. One in a list is not: those of its vertices
//! that have gone into others are replaced by them when it is next read, so that a hub of a hundred
//! thousand faces costs its neighbours nothing.

use glam::Vec4;
use rayon::prelude::*;

use crate::kernel::mesh::vertex::{Bf16, NO_VERTEX, RING, Vertex, VertexFlags, VertexQuadric};
use std::ops::Range;

/// The length of a ring that is in a list, by the first number in its place; the second is a count.
pub(crate) const LONG: u8 = u8::MAX;

/// No edge is contracted to make a ring longer than this; a vertex whose ring is, waits until its
/// neighbours have become fewer. Costs grow with the square of it.
pub(crate) const MAX_RING: usize = 64;

/// The vertex that closes the rings of boundary vertices. It has no record of its own.
pub(crate) const GHOST: u32 = u32::MAX - 1;

/// What the ghost looks like, and vertices of other parts: edges to them are not contracted.
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

/// All vertices, dead ones too, and the rings that they have no room for.
pub(crate) struct VertexStore {
    pub(crate) all: Vec<Vertex>,
    pub(crate) long: Vec<LongRing>,
    /// The vertices that the last ones are copies of.
    pub(crate) copied: Vec<u32>,
    /// The vertices that have copies, in order.
    pub(crate) split: Vec<u32>,
    /// What a boundary edge counts.
    pub(crate) boundary_weight: f32,
}

/// A ring in a list, of a vertex that may have another by now.
pub(crate) struct LongRing {
    pub(crate) of: u32,
    ring: Vec<u32>,
}

/// A run of the vertices. Of others it knows only the ids.
pub(crate) struct Vertices<'v> {
    pub(crate) all: &'v mut [Vertex],
    /// The id of the first.
    pub(crate) base: u32,
    pub(crate) long: &'v mut Vec<LongRing>,
    /// The vertices that those from `first_copy` on are copies of.
    pub(crate) copied: &'v [u32],
    pub(crate) split: &'v [u32],
    pub(crate) first_copy: u32,
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
        Self { all, long, copied, split, boundary_weight }
    }

    /// All of the vertices.
    pub(crate) fn whole(&mut self) -> Vertices<'_> {
        let first_copy = self.own() as u32;
        let Self { all, long, copied, split, .. } = self;
        Vertices { all, base: 0, long, copied, split, first_copy }
    }

    /// How many of the vertices are the input's.
    pub(crate) fn own(&self) -> usize {
        self.all.len() - self.copied.len()
    }

    /// The vertex of the input that it is, or is a copy of.
    pub(crate) fn origin(&self, v: u32) -> u32 {
        (v as usize).checked_sub(self.own()).map_or(v, |copy| self.copied[copy])
    }

    /// The live vertex that each is or has gone into.
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
    /// Vertices of which none is a copy.
    pub(crate) fn new(all: &'v mut [Vertex], base: u32, long: &'v mut Vec<LongRing>) -> Self {
        Self { all, base, long, copied: &[], split: &[], first_copy: GHOST }
    }

    /// Their ids.
    pub(crate) fn ids(&self) -> Range<u32> {
        self.base..self.base + self.all.len() as u32
    }

    /// Takes over the lists of a part of it.
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

    /// A vertex; of the ghost and of those in other parts, only that they are not to be touched.
    #[inline(always)]
    pub(crate) fn get(&self, v: u32) -> &Vertex {
        self.all.get(v.wrapping_sub(self.base) as usize).unwrap_or(&ELSEWHERE)
    }

    /// A vertex of this part.
    #[inline(always)]
    pub(crate) fn get_mut(&mut self, v: u32) -> &mut Vertex {
        &mut self.all[v.wrapping_sub(self.base) as usize]
    }

    /// The vertex of the input that it is, or is a copy of.
    #[inline]
    pub(crate) fn origin(&self, v: u32) -> u32 {
        if v < self.first_copy || v == GHOST {
            return v;
        }
        self.copied[(v - self.first_copy) as usize]
    }

    /// Whether it is one of several copies of a vertex where the surface is not manifold.
    pub(crate) fn is_split(&self, v: u32) -> bool {
        (v >= self.first_copy && v != GHOST) || self.split.binary_search(&v).is_ok()
    }

    /// The live vertex that this one is or has gone into.
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

    /// Brings its ring up to date.
    #[inline(always)]
    pub(crate) fn refresh(&mut self, v: u32) {
        if self.get(v).len == LONG {
            self.refresh_long(v);
        }
    }

    /// Its neighbours, counter-clockwise, as last brought up to date.
    #[inline(always)]
    pub(crate) fn neighbours(&self, v: u32) -> &[u32] {
        let vertex = self.get(v);
        match vertex.len {
            LONG => &self.long[vertex.ring[0] as usize].ring,
            len => &vertex.ring[..len as usize],
        }
    }

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

    /// Gives it the first `len` of these as neighbours.
    #[inline(always)]
    pub(crate) fn set_ring_of<const N: usize>(&mut self, v: u32, ring: &[u32; N], len: usize) {
        if len > RING {
            return self.set_long(v, &ring[..len]);
        }
        let vertex = self.get_mut(v);
        // All of the room, always: a copy of unknown length is a call.
        vertex.ring.copy_from_slice(&ring[..RING]);
        vertex.len = len as u8;
    }

    /// Gives it these neighbours.
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
    /// Takes a neighbour out; true if that has made a hub into a vertex like others.
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
            // All of it, always: a move of unknown length is a call.
            for i in 0..RING - 1 {
                let (here, next) = (self.ring[i], self.ring[i + 1]);
                self.ring[i] = if (i as u32) < at as u32 { here } else { next };
            }
            self.len -= 1;
        }
        false
    }

    /// Puts a neighbour in the place of another.
    #[inline(always)]
    pub(crate) fn replace_neighbour(&mut self, gone: u32, kept: u32) {
        if self.len != LONG {
            for w in &mut self.ring {
                *w = if *w == gone { kept } else { *w };
            }
        }
    }
}

/// Where it is among the first `len` of a ring, found without a guess.
#[inline(always)]
pub(crate) fn index_in_ring(ring: &[u32; RING], len: usize, v: u32) -> Option<usize> {
    let (len, mut beyond) = (len as u32, 0);
    for (i, &w) in (1..).zip(ring) {
        beyond += if (w == v) & (i <= len) { i } else { 0 };
    }
    (beyond as usize).checked_sub(1)
}

/// Where it is in a ring.
#[inline(always)]
pub(crate) fn index_in(ring: &[u32], v: u32) -> Option<usize> {
    ring.iter().position(|&w| w == v)
}

#[inline(always)]
pub(crate) fn is_seam(vertices: &Vertices, v: u32) -> bool {
    vertices.get(v).flags.any(VertexFlags::SEAM)
}
