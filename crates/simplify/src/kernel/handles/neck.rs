//! Three edges around a handle, and the cut along them.

use std::collections::VecDeque;

use rustc_hash::FxHashMap;

use crate::kernel::mesh::one_ring::{GHOST, Vertices, index_in, is_seam};
use crate::kernel::mesh::vertex::{Bf16, NO_VERTEX, Vertex, VertexFlags, VertexQuadric};
use crate::kernel::metric::Metric;
use crate::kernel::schedule::bucket_queue::NONE;

/// Number of vertices that a cut needs.
pub(crate) const PER_CUT: usize = 3;

/// Vertices that must not be parted.
const WHOLE: VertexFlags =
    VertexFlags(VertexFlags::HELD.0 | VertexFlags::SEAM.0 | VertexFlags::SHUT.0);

/// Largest number of vertices that are visited to find a way around a handle.
const MOST_VISITED: usize = 1 << 14;

/// Three vertices with an edge between any two, but no face.
///
/// The near side is to the left of the way from the first to the second to the third.
pub(crate) struct Neck {
    pub(crate) vertices: [u32; 3],
    /// Neighbours of each of the three on the near side, counter-clockwise.
    near: [Vec<u32>; 3],
    far: [Vec<u32>; 3],
}

/// Records and rings of all vertices that a cut has changed.
pub(crate) struct Uncut {
    vertices: Vec<(u32, Vertex, Vec<u32>)>,
    long: usize,
}

impl Neck {
    /// Returns the neck of an edge and a vertex that both ends have for a neighbour, but not for a
    /// wing; `None` if a vertex of it must not be parted.
    pub(crate) fn new(vertices: &mut Vertices<'_>, three: [u32; 3]) -> Option<Self> {
        let must_stay = |&v: &u32| v == GHOST || vertices.get(v).flags.any(WHOLE);
        if three.iter().any(must_stay) {
            return None;
        }
        three.iter().for_each(|&v| vertices.refresh(v));
        let between = |k: usize, from: usize, to: usize| {
            arc(vertices.neighbours(three[k]), three[(k + from) % 3], three[(k + to) % 3])
        };
        let neck = Self {
            vertices: three,
            near: [between(0, 1, 2)?, between(1, 1, 2)?, between(2, 1, 2)?],
            far: [between(0, 2, 1)?, between(1, 2, 1)?, between(2, 2, 1)?],
        };
        // The sectors at a seam do not hear of the copies.
        let is_seam = |&v: &u32| v != GHOST && is_seam(vertices, v);
        (!neck.near.iter().chain(&neck.far).flatten().any(is_seam)).then_some(neck)
    }

    /// Returns each vertex with its copy.
    pub(crate) fn copies(&self, first_copy: u32) -> [[u32; 2]; PER_CUT] {
        let [v0, v1, w] = self.vertices;
        [[v0, first_copy], [v1, first_copy + 1], [w, first_copy + 2]]
    }

    /// Returns true if a vertex follows in a far face of the vertex with this index. Others of the
    /// neck may have been replaced by their copies.
    pub(crate) fn is_far(&self, k: usize, follows: u32, first_copy: u32) -> bool {
        let last = (k + 2) % 3;
        let is_last = follows == self.vertices[last] || follows == first_copy + last as u32;
        is_last || self.far[k].contains(&follows)
    }

    /// Cuts along the neck and closes both sides with a face. The vertices stay on the near side,
    /// and the three from `first_copy` on take their place on the far side.
    pub(crate) fn cut<M: Metric>(
        &self,
        vertices: &mut Vertices<'_>,
        first_copy: u32,
        boundary_weight: f32,
    ) -> Uncut {
        let copies: [u32; PER_CUT] = [first_copy, first_copy + 1, first_copy + 2];
        let around = self.far.iter().flatten().copied().filter(|&w| w != GHOST);
        let all = self.vertices.into_iter().chain(copies).chain(around);
        let record = |v: u32| {
            vertices.refresh(v);
            (v, *vertices.get(v), vertices.neighbours(v).to_vec())
        };
        let uncut = Uncut { vertices: all.map(record).collect(), long: vertices.long.len() };
        for k in 0..3 {
            let [next, last] = [(k + 1) % 3, (k + 2) % 3];
            let (v, copy) = (self.vertices[k], copies[k]);
            *vertices.get_mut(copy) = copy_of(vertices.get(v));
            for &w in self.far[k].iter().filter(|&&w| w != GHOST) {
                vertices.replace_neighbour(w, v, copy);
                // Its cheapest edge may have led to the near side.
                vertices.get_mut(w).target = NO_VERTEX;
            }
            let near = [&[self.vertices[next]], &self.near[k][..], &[self.vertices[last]]].concat();
            let far = [&[copies[last]], &self.far[k][..], &[copies[next]]].concat();
            vertices.set_ring(v, &near);
            vertices.set_ring(copy, &far);
        }
        for v in self.vertices.into_iter().chain(copies) {
            renew::<M>(vertices, v, boundary_weight);
        }
        uncut
    }
}

impl Uncut {
    /// Takes the cut back.
    pub(crate) fn restore(self, vertices: &mut Vertices<'_>) {
        vertices.long.truncate(self.long);
        // A vertex may have been noted twice, the same each time.
        for (v, vertex, ring) in self.vertices {
            *vertices.get_mut(v) = vertex;
            vertices.set_ring(v, &ring);
        }
    }
}

/// Returns the vertices that both ends of an edge have for a neighbour, but not for a wing.
pub(crate) fn across(vertices: &mut Vertices<'_>, [v0, v1]: [u32; 2]) -> Vec<u32> {
    vertices.refresh(v0);
    vertices.refresh(v1);
    let (ring0, ring1) = (vertices.neighbours(v0), vertices.neighbours(v1));
    let Some(at) = index_in(ring0, v1) else { return Vec::new() };
    let wings = [ring0[(at + 1) % ring0.len()], ring0[(at + ring0.len() - 1) % ring0.len()]];
    let is_across = |w: &&u32| !wings.contains(w) && ring1.contains(w);
    ring0.iter().filter(is_across).copied().collect()
}

/// Returns the neighbours in a ring between two, counter-clockwise.
fn arc(ring: &[u32], from: u32, to: u32) -> Option<Vec<u32>> {
    let (from, to) = (index_in(ring, from)?, index_in(ring, to)?);
    let count = (to + ring.len() - from) % ring.len();
    Some((1..count).map(|i| ring[(from + i) % ring.len()]).collect())
}

fn copy_of(vertex: &Vertex) -> Vertex {
    let mut flags = vertex.flags;
    flags.clear(VertexFlags::STALE);
    Vertex { flags, len: 0, floor: 0, bucket: NONE, target: NO_VERTEX, ..*vertex }
}

/// Gives a vertex the quadric of its faces, without what it remembers.
fn renew<M: Metric>(vertices: &mut Vertices<'_>, v: u32, boundary_weight: f32) {
    let place = vertices.get(v).place();
    let along = |w: u32| vertices.get(w).place() - place;
    let mut quadric = VertexQuadric([place.extend(0.0), glam::Vec4::ZERO, glam::Vec4::ZERO]);
    let ring = vertices.neighbours(v);
    for (i, &a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        if a != GHOST && b != GHOST {
            quadric.add(&M::face(along(a).cross(along(b))));
            continue;
        }
        // The boundary edge of the last face before the ghost, or of the first one behind it.
        let (end, other) = match b == GHOST {
            true => (a, ring[(i + ring.len() - 1) % ring.len()]),
            false => (b, ring[(i + 2) % ring.len()]),
        };
        let normal = along(end).cross(along(other));
        quadric.add(&M::boundary(along(end), normal, boundary_weight));
    }
    let vertex = vertices.get_mut(v);
    vertex.quadric = quadric;
    vertex.constant = Bf16::NONE;
    vertex.flags.set(VertexFlags::STALE);
}

/// Returns true if a way is found along edges from one vertex to the other. Ways longer than what a
/// search from both ends visits are not.
pub(crate) fn are_joined(vertices: &mut Vertices<'_>, ends: [u32; 2]) -> bool {
    let mut side_of: FxHashMap<u32, usize> = (0..).zip(ends).map(|(i, v)| (v, i)).collect();
    let mut fronts = ends.map(|v| VecDeque::from([v]));
    while side_of.len() < MOST_VISITED {
        for side in 0..2 {
            // One side alone: nothing more is to be found.
            let Some(v) = fronts[side].pop_front() else { return false };
            vertices.refresh(v);
            for &w in vertices.neighbours(v).iter().filter(|&&w| w != GHOST) {
                let found = *side_of.entry(w).or_insert_with(|| {
                    fronts[side].push_back(w);
                    side
                });
                if found != side {
                    return true;
                }
            }
        }
    }
    false
}
