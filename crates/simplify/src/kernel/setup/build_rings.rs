//! Builds one-rings from faces. The faces around a manifold vertex are one fan, closed or open; an
//! open one is closed by the ghost.

use glam::Vec3;
use rayon::prelude::*;

use crate::kernel::mesh::one_ring::{GHOST, LONG, LongRing, VertexStore, Vertices};
use crate::kernel::mesh::vertex::{NO_VERTEX, RING, Vertex};
use crate::kernel::metric::Metric;
use crate::kernel::setup::face_blocks::{CELL, CellFaces};
use crate::kernel::setup::split_non_manifold::Pair;

/// Number of neighbour pairs that a vertex has room for before they are a ring.
const PAIRS: usize = RING / 2;

/// Vertices with rings, and the vertices for which there is no ring.
pub(crate) struct Fans {
    pub(crate) store: VertexStore,
    /// Number of faces with three different vertices.
    pub(crate) faces: usize,
    /// Vertices whose faces are not one fan, in order. They have no ring.
    pub(crate) irregular: Vec<u32>,
}

impl Fans {
    /// Builds the rings of vertices at these places from `count` faces; copies come last.
    pub(crate) fn new<M: Metric>(
        (places, copied): (&[Vec3], Vec<u32>),
        count: usize,
        face: impl Fn(usize) -> [u32; 3] + Sync,
        boundary_weight: f32,
    ) -> Self {
        let cells = CellFaces::new(places.len(), count, face);
        // With room for vertices of cuts, which takes no memory before it is used.
        let mut all = Vec::with_capacity(places.len() + places.len() / 8);
        places.par_iter().map(|&place| Vertex::at(place)).collect_into_vec(&mut all);
        let close = |(number, all)| close::<M>((number, all), places, &cells, boundary_weight);
        let closed: Vec<_> = all.par_chunks_mut(CELL).enumerate().map(close).collect();
        let (mut long, mut irregular) = (Vec::new(), Vec::new());
        for (lists, odd) in closed {
            long.push(lists);
            irregular.extend(odd);
        }
        let store = VertexStore::new(all, copied, long, boundary_weight);
        Self { store, faces: cells.faces, irregular }
    }
}

/// Builds the rings of a cell. Returns the long ones, and the vertices without one.
fn close<M: Metric>(
    (number, all): (usize, &mut [Vertex]),
    places: &[Vec3],
    cells: &CellFaces,
    boundary_weight: f32,
) -> (Vec<LongRing>, Vec<u32>) {
    let mut long = Vec::new();
    let vertices = Vertices::new(all, (number * CELL) as u32, &mut long);
    let mut cell = Cell { number, vertices, places, boundary_weight, irregular: Vec::new() };
    cell.close::<M>(cells);
    let irregular = cell.irregular;
    (long, irregular)
}

/// A run of vertices whose rings are being built.
struct Cell<'c> {
    number: usize,
    vertices: Vertices<'c>,
    /// Places of all vertices.
    places: &'c [Vec3],
    boundary_weight: f32,
    irregular: Vec<u32>,
}

impl Cell<'_> {
    fn close<M: Metric>(&mut self, cells: &CellFaces) {
        let mut beyond = self.collect::<M>(cells);
        beyond.sort_by_key(|&(v, _)| v);
        let mut beyond = &beyond[..];
        let mut pairs = Vec::new();
        for v in self.vertices.ids() {
            let vertex = self.vertices.get_mut(v);
            let len = vertex.len as usize;
            if len == 0 {
                continue;
            }
            let more = beyond.iter().take_while(|(of, _)| *of == v).count();
            if more == 0 {
                self.ring_of::<M>(v, len);
            } else {
                pairs.clear();
                pairs.extend_from_slice(vertex.ring.as_chunks().0);
                pairs.extend(beyond[..more].iter().map(|&(_, pair)| pair));
                beyond = &beyond[more..];
                self.ring_of_many::<M>(v, &mut pairs);
            }
        }
    }

    /// Gives each vertex the quadric and the pairs of its faces. Returns the pairs that it has no
    /// room for.
    fn collect<M: Metric>(&mut self, cells: &CellFaces) -> Vec<(u32, Pair)> {
        let (places, first) = (self.places, self.vertices.base);
        let all = &mut *self.vertices.all;
        let mut beyond = Vec::new();
        for &[a, b, c] in cells.of(self.number).flatten() {
            let place = |v: u32| places[v as usize];
            let star = M::face((place(b) - place(a)).cross(place(c) - place(a)));
            for (v, pair) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
                let Some(vertex) = all.get_mut(v.wrapping_sub(first) as usize) else { continue };
                vertex.quadric.add(&star);
                let at = vertex.len as usize;
                if at < PAIRS {
                    vertex.ring.as_chunks_mut().0[at] = pair;
                    vertex.len += 1;
                } else {
                    beyond.push((v, pair));
                }
            }
        }
        beyond
    }

    /// Builds the ring of a vertex whose pairs are all in the vertex.
    #[inline(always)]
    fn ring_of<M: Metric>(&mut self, v: u32, len: usize) {
        let vertex = self.vertices.get_mut(v);
        let ring = vertex.ring;
        match closed(&ring, len) {
            Some(closed) => vertex.ring = closed,
            None => self.ring_not_closed::<M>(v, &mut ring.as_chunks().0[..len].to_vec()),
        }
    }

    #[cold]
    fn ring_not_closed<M: Metric>(&mut self, v: u32, pairs: &mut [Pair]) {
        match chain_open(pairs) {
            Some(()) => self.open::<M>(v, pairs),
            None => self.irregular(v),
        }
    }

    /// Builds the ring of a vertex with many faces by sorting: a search for each pair would take
    /// quadratic time.
    fn ring_of_many<M: Metric>(&mut self, v: u32, pairs: &mut Vec<Pair>) {
        match chain_many(pairs) {
            Some(Chain::Closed) => {
                let ring: Vec<u32> = pairs.iter().map(|pair| pair[0]).collect();
                self.vertices.set_ring(v, &ring);
            }
            Some(Chain::Open) => self.open::<M>(v, pairs),
            None => self.irregular(v),
        }
    }

    fn irregular(&mut self, v: u32) {
        self.vertices.get_mut(v).len = 0;
        self.irregular.push(v);
    }

    /// Sets a ring through the ghost, and adds the two boundary edges.
    fn open<M: Metric>(&mut self, v: u32, pairs: &[Pair]) {
        let (first, last) = (pairs[0][0], pairs[pairs.len() - 1][1]);
        let mut ring: Vec<u32> = pairs.iter().map(|pair| pair[0]).collect();
        ring.extend([last, GHOST]);
        self.vertices.set_ring(v, &ring);
        let along = |w: u32| self.places[w as usize] - self.places[v as usize];
        for (end, [a, b]) in [(first, pairs[0]), (last, pairs[pairs.len() - 1])] {
            let edge = M::boundary(along(end), along(a).cross(along(b)), self.boundary_weight);
            self.vertices.get_mut(v).quadric.add(&edge);
        }
    }
}

/// Kind of a fan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Chain {
    Closed,
    Open,
}

/// Weight of the first entry of each pair in [`closed`]: one in the upper half, and its index in
/// the lower.
const FIRSTS: [u32; RING] = {
    let (mut counts, mut pair) = ([0; RING], 0);
    while pair < PAIRS {
        counts[2 * pair] = (1 << 16) | (2 * pair) as u32;
        pair += 1;
    }
    counts
};

/// Returns the ring of `len` pairs that form a closed fan. There is no early exit, which would be
/// mispredicted as often as not.
#[inline(always)]
fn closed(pairs: &[u32; RING], len: usize) -> Option<[u32; RING]> {
    let (mut ring, mut next) = ([NO_VERTEX; RING], pairs[1]);
    ring[0] = pairs[0];
    for slot in ring.iter_mut().take(len).skip(1) {
        let mut found = 0;
        for (&w, count) in pairs.iter().zip(FIRSTS) {
            found += if w == next { count } else { 0 };
        }
        if found >> 16 != 1 || next == pairs[0] {
            return None;
        }
        *slot = next;
        next = pairs[(found as usize & (RING - 1)) + 1];
    }
    (next == pairs[0] && len > 1).then_some(ring)
}

/// Sorts pairs such that each begins where the one before ends; `None` if they are not one open
/// fan.
fn chain_open(pairs: &mut [Pair]) -> Option<()> {
    let is_end = |v: u32| pairs.iter().any(|pair| pair[1] == v);
    let first = pairs.iter().position(|pair| !is_end(pair[0]))?;
    pairs.swap(0, first);
    for sorted in 1..pairs.len() {
        let want = pairs[sorted - 1][1];
        let found = sorted + pairs[sorted..].iter().position(|pair| pair[0] == want)?;
        pairs.swap(sorted, found);
    }
    are_distinct(pairs).then_some(())
}

/// Returns true if no neighbour occurs twice in an open fan.
fn are_distinct(pairs: &[Pair]) -> bool {
    let mut all: Vec<u32> = pairs.iter().map(|pair| pair[0]).collect();
    all.push(pairs[pairs.len() - 1][1]);
    all.sort_unstable();
    all.windows(2).all(|two| two[0] != two[1])
}

/// Sorts many pairs into one fan; `None` if they are not one.
fn chain_many(pairs: &mut Vec<Pair>) -> Option<Chain> {
    let mut sorted = std::mem::take(pairs);
    sorted.sort_unstable();
    if sorted.windows(2).any(|two| two[0][0] == two[1][0]) {
        return None;
    }
    let mut ends: Vec<u32> = sorted.iter().map(|pair| pair[1]).collect();
    ends.sort_unstable();
    let is_end = |v: u32| ends.binary_search(&v).is_ok();
    let first = sorted.iter().position(|pair| !is_end(pair[0])).unwrap_or(0);
    let mut next = first;
    loop {
        pairs.push(sorted[next]);
        match sorted.binary_search_by_key(&sorted[next][1], |pair| pair[0]) {
            Ok(found) if found != first => next = found,
            Ok(_) => return (pairs.len() == sorted.len()).then_some(Chain::Closed),
            Err(_) => break,
        }
        if pairs.len() > sorted.len() {
            return None;
        }
    }
    (pairs.len() == sorted.len() && are_distinct(pairs)).then_some(Chain::Open)
}

const _: () = assert!(PAIRS < LONG as usize);
