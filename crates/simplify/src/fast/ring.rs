//! Rings: sixteen neighbours in the vertex itself, more of them in a list beside.
//!
//! A ring in the vertex is kept up by every contraction. One in a list is not: those of its vertices
//! that have gone into others are replaced by them when it is next read, so that a hub of a hundred
//! thousand faces costs its neighbours nothing.

use crate::fast::vertex::{Flags, Vertex};

/// How many neighbours a vertex has room for. Of horse-97k's vertices on the way to 1 %, fewer than
/// one in a thousand have more.
pub(super) const RING: usize = 16;

/// The length of a ring that is in a list, by the first number in its place; the second is a count.
pub(super) const LONG: u8 = u8::MAX;

/// No edge is contracted to make a ring longer than this; a vertex whose ring is, waits until its
/// neighbours have become fewer. Costs grow with the square of it.
pub(super) const MOST: usize = 64;

/// All vertices, dead ones and the ghost too, and the rings that they have no room for.
pub(super) struct Vertices {
    pub(super) all: Vec<Vertex>,
    long: Vec<Vec<u32>>,
    /// The vertex that closes the rings of boundary vertices.
    pub(super) ghost: u32,
    /// The vertices of the input that those after the ghost are copies of.
    pub(super) copied: Vec<u32>,
}

impl Vertices {
    pub(super) fn new(all: Vec<Vertex>, ghost: u32, copied: Vec<u32>) -> Self {
        Self { all, long: Vec::new(), ghost, copied }
    }

    #[inline(always)]
    pub(super) fn get(&self, v: u32) -> &Vertex {
        &self.all[v as usize]
    }

    #[inline(always)]
    pub(super) fn get_mut(&mut self, v: u32) -> &mut Vertex {
        &mut self.all[v as usize]
    }

    /// The vertex of the input that it is, or is a copy of.
    #[inline]
    pub(super) fn origin(&self, v: u32) -> u32 {
        if v > self.ghost { self.copied[(v - self.ghost - 1) as usize] } else { v }
    }

    /// The live vertex that each is or has gone into.
    pub(super) fn heirs(&self) -> Vec<u32> {
        let next = |(v, vertex): (u32, &Vertex)| match vertex.flags.any(Flags::DEAD) {
            true => vertex.target,
            false => v,
        };
        let mut heirs: Vec<u32> = (0..).zip(&self.all).map(next).collect();
        for v in 0..heirs.len() {
            let mut last = heirs[v];
            while heirs[last as usize] != last {
                last = heirs[last as usize];
            }
            let mut at = v;
            while heirs[at] != last {
                at = std::mem::replace(&mut heirs[at], last) as usize;
            }
        }
        heirs
    }

    /// The live vertex that this one is or has gone into.
    pub(super) fn heir(&mut self, mut v: u32) -> u32 {
        while self.get(v).flags.any(Flags::DEAD) {
            let next = self.get(v).target;
            let beyond = *self.get(next);
            if beyond.flags.any(Flags::DEAD) {
                self.get_mut(v).target = beyond.target;
            }
            v = next;
        }
        v
    }

    /// Brings its ring up to date.
    #[inline(always)]
    pub(super) fn bring_up(&mut self, v: u32) {
        if self.get(v).len == LONG {
            self.settle(v);
        }
    }

    /// Its neighbours, counter-clockwise, as last brought up to date.
    #[inline(always)]
    pub(super) fn settled(&self, v: u32) -> &[u32] {
        let vertex = self.get(v);
        match vertex.len {
            LONG => &self.long[vertex.ring[0] as usize],
            len => &vertex.ring[..len as usize],
        }
    }

    #[cold]
    fn settle(&mut self, v: u32) {
        let slot = self.get(v).ring[0] as usize;
        let mut list = std::mem::take(&mut self.long[slot]);
        list.iter_mut().for_each(|w| *w = self.heir(*w));
        list.dedup();
        while list.len() > 1 && list.first() == list.last() {
            list.pop();
        }
        self.get_mut(v).ring[1] = list.len() as u32;
        self.long[slot] = list;
        if self.long[slot].len() <= RING {
            let list = std::mem::take(&mut self.long[slot]);
            self.set_ring(v, &list);
        }
    }

    /// Gives it the first `len` of these as neighbours.
    #[inline(always)]
    pub(super) fn set_ring_of<const N: usize>(&mut self, v: u32, ring: &[u32; N], len: usize) {
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
    pub(super) fn set_ring(&mut self, v: u32, ring: &[u32]) {
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
                self.long.push(Vec::new());
                self.long.len() - 1
            }
        };
        self.long[slot] = ring.to_vec();
        let vertex = self.get_mut(v);
        vertex.len = LONG;
        vertex.ring[..2].copy_from_slice(&[slot as u32, ring.len() as u32]);
        if ring.len() > MOST {
            vertex.flags.set(Flags::BARRED);
        }
    }
}

impl Vertex {
    /// Takes a neighbour out; true if that has made a hub into a vertex like others.
    #[inline(always)]
    pub(super) fn lose(&mut self, neighbour: u32) -> bool {
        if self.len == LONG {
            self.ring[1] = self.ring[1].saturating_sub(1);
            let shrunk = self.flags.any(Flags::BARRED) && self.ring[1] as usize <= MOST;
            if shrunk {
                self.flags.clear(Flags::BARRED);
            }
            return shrunk;
        }
        let len = self.len as usize;
        if let Some(at) = place_in(&self.ring[..len], neighbour) {
            // All of it, always: a move of unknown length is a call.
            for i in 0..RING - 1 {
                self.ring[i] = if i < at { self.ring[i] } else { self.ring[i + 1] };
            }
            self.len -= 1;
        }
        false
    }

    /// Puts a neighbour in the place of another.
    #[inline(always)]
    pub(super) fn swap(&mut self, gone: u32, kept: u32) {
        if self.len != LONG {
            for w in &mut self.ring {
                *w = if *w == gone { kept } else { *w };
            }
        }
    }
}

/// Where it is in a ring.
#[inline(always)]
pub(super) fn place_in(ring: &[u32], v: u32) -> Option<usize> {
    ring.iter().position(|&w| w == v)
}
