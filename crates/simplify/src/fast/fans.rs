//! From faces to rings. Around a vertex where the surface is manifold, the faces are one fan, closed or
//! open; an open one is closed by the ghost.

use glam::Vec3;

use crate::fast::engine::BOUNDARY_WEIGHT;
use crate::fast::ring::{LONG, RING, Vertices};
use crate::fast::vertex::{Flags, Star, Vertex};

/// Pairs of neighbours that a vertex has room for before they are a ring.
const PAIRS: usize = RING / 2;

/// Faces made vertices with rings, and those where that cannot be done.
pub(super) struct Fans {
    pub(super) vertices: Vertices,
    /// Faces of three different vertices.
    pub(super) faces: usize,
    /// Vertices whose faces are not one fan. They have no ring.
    pub(super) irregular: Vec<u32>,
}

/// The two other corners of a face, in its turn.
pub(super) type Pair = [u32; 2];

impl Fans {
    /// Rings of `places` and the ghost behind the first `own` of them; what follows it is copies.
    pub(super) fn new(
        places: impl ExactSizeIterator<Item = Vec3>,
        copied: Vec<u32>,
        faces: impl Iterator<Item = [u32; 3]>,
    ) -> Self {
        let ghost = places.len() - copied.len();
        let mut all = Vec::with_capacity(places.len() + 1);
        for (i, place) in places.enumerate() {
            if i == ghost {
                all.push(ghost_vertex());
            }
            all.push(Vertex::at(place));
        }
        if all.len() == ghost {
            all.push(ghost_vertex());
        }
        let mut beyond = Vec::new();
        let mut count = 0;
        for [a, b, c] in faces {
            if a == b || b == c || c == a {
                continue;
            }
            count += 1;
            let place = |v: u32| all[v as usize].place();
            let star = Star::face((place(b) - place(a)).cross(place(c) - place(a)));
            for (v, pair) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
                let vertex = &mut all[v as usize];
                vertex.seen.add(&star);
                let at = vertex.len as usize;
                if at < PAIRS {
                    vertex.ring[2 * at..2 * at + 2].copy_from_slice(&pair);
                    vertex.len += 1;
                } else {
                    beyond.push((v, pair));
                }
            }
        }
        let vertices = Vertices::new(all, ghost as u32, copied);
        let mut fans = Self { vertices, faces: count, irregular: Vec::new() };
        fans.close(beyond);
        fans
    }

    /// Makes rings of the pairs.
    fn close(&mut self, mut beyond: Vec<(u32, Pair)>) {
        beyond.sort_by_key(|&(v, _)| v);
        let mut beyond = &beyond[..];
        let mut pairs = Vec::new();
        for v in 0..self.vertices.all.len() as u32 {
            let vertex = self.vertices.get_mut(v);
            let len = vertex.len as usize;
            if len == 0 {
                continue;
            }
            let mut near = [[0; 2]; PAIRS];
            near[..len].copy_from_slice(&vertex.ring.as_chunks().0[..len]);
            let more = beyond.iter().take_while(|(of, _)| *of == v).count();
            if more == 0 {
                self.ring_of(v, &mut near[..len]);
            } else {
                pairs.clear();
                pairs.extend_from_slice(&near);
                pairs.extend(beyond[..more].iter().map(|&(_, pair)| pair));
                beyond = &beyond[more..];
                self.ring_of_many(v, &mut pairs);
            }
        }
    }

    #[inline(always)]
    fn ring_of(&mut self, v: u32, pairs: &mut [Pair]) {
        match chain(pairs) {
            Some(Chain::Closed) => {
                let vertex = self.vertices.get_mut(v);
                for (w, pair) in vertex.ring.iter_mut().zip(&*pairs) {
                    *w = pair[0];
                }
            }
            Some(Chain::Open) => self.open(v, pairs),
            None => self.irregular(v),
        }
    }

    /// Of a vertex with many faces, by sorting: a search for each would cost the square of them.
    fn ring_of_many(&mut self, v: u32, pairs: &mut Vec<Pair>) {
        match chain_many(pairs) {
            Some(Chain::Closed) => {
                let ring: Vec<u32> = pairs.iter().map(|pair| pair[0]).collect();
                self.vertices.set_ring(v, &ring);
            }
            Some(Chain::Open) => self.open(v, pairs),
            None => self.irregular(v),
        }
    }

    fn irregular(&mut self, v: u32) {
        self.vertices.get_mut(v).len = 0;
        self.irregular.push(v);
    }

    /// A ring through the ghost, and the edges to it.
    fn open(&mut self, v: u32, pairs: &[Pair]) {
        let (first, last) = (pairs[0][0], pairs[pairs.len() - 1][1]);
        let mut ring: Vec<u32> = pairs.iter().map(|pair| pair[0]).collect();
        ring.extend([last, self.vertices.ghost]);
        self.vertices.set_ring(v, &ring);
        let place = self.vertices.get(v).place();
        for end in [first, last] {
            let end = self.vertices.get(end).place();
            let edge = Star::boundary(end - place, BOUNDARY_WEIGHT);
            self.vertices.get_mut(v).seen.add(&edge);
        }
    }
}

fn ghost_vertex() -> Vertex {
    let mut ghost = Vertex::at(Vec3::ZERO);
    ghost.flags.set(Flags::BARRED);
    ghost
}

/// A fan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Chain {
    Closed,
    Open,
}

/// Sorts pairs so that each begins with what the one before ends with; `None` if that is not one fan.
#[inline(always)]
fn chain(pairs: &mut [Pair]) -> Option<Chain> {
    for sorted in 1..pairs.len() {
        let want = pairs[sorted - 1][1];
        let mut found = None;
        for (i, pair) in pairs.iter().enumerate().skip(sorted) {
            if pair[0] == want {
                if found.is_some() {
                    return None;
                }
                found = Some(i);
            }
        }
        match found {
            Some(i) => pairs.swap(sorted, i),
            None => return chain_open(pairs, sorted),
        }
    }
    if pairs[pairs.len() - 1][1] == pairs[0][0] && pairs.len() > 1 {
        return Some(Chain::Closed);
    }
    distinct(pairs).then_some(Chain::Open)
}

/// Goes on from the front of the first `sorted`, which end at a boundary.
#[cold]
fn chain_open(pairs: &mut [Pair], sorted: usize) -> Option<Chain> {
    for sorted in sorted..pairs.len() {
        let want = pairs[0][0];
        let found = sorted + pairs[sorted..].iter().position(|pair| pair[1] == want)?;
        pairs.swap(sorted, found);
        pairs[..=sorted].rotate_right(1);
    }
    distinct(pairs).then_some(Chain::Open)
}

/// Whether no neighbour stands twice in an open fan.
fn distinct(pairs: &[Pair]) -> bool {
    let mut all: Vec<u32> = pairs.iter().map(|pair| pair[0]).collect();
    all.push(pairs[pairs.len() - 1][1]);
    all.sort_unstable();
    all.windows(2).all(|two| two[0] != two[1])
}

/// The same of many pairs.
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
    (pairs.len() == sorted.len() && distinct(pairs)).then_some(Chain::Open)
}

const _: () = assert!(PAIRS < LONG as usize);
