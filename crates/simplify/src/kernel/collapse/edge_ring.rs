//! The one-ring of an edge, gathered once for all checks of a contraction.
//!
//! ```text
//!        x1 = ids[0]                The ring of the new vertex: first the neighbours of v0, from
//!       /  | \                      wing to wing, then the other neighbours of v1. Spoke i is the
//!   x2 —— v0 — v1 —— y              face of ids[i], ids[i + 1] and v0, or v1 for the last ones.
//!       \  | /                      The ghost has a place in the ring too; its faces have no area.
//!        xk = ids[of_v0]
//! ```

use std::ops::Range;

use glam::{DVec3, Vec3, Vec4};

use crate::kernel::mesh::one_ring::{GHOST, LONG, MAX_RING, Vertices, index_in, index_in_ring};
use crate::kernel::mesh::vertex::{RING, VertexFlags, VertexQuadric, per_square};
use crate::kernel::simd::{LANES, Row, Row3, select_max, sum_of, transpose, transpose_back};
use crate::refusal::Refusal;

/// Room for the longest ring and the lanes beyond its end.
pub(crate) const ROOM: usize = MAX_RING + 2 * LANES;

/// Smallest cosine between the normals of a face before and after, as in the policy engine.
const MIN_COSINE: f32 = 0.2;

/// One-ring of an edge, with positions relative to its end `v0`.
#[derive(Clone)]
pub(crate) struct EdgeRing {
    /// Vertices of the ring.
    pub(crate) ids: [u32; ROOM],
    /// Number of vertices in the ring.
    pub(crate) len: usize,
    /// Number of spokes at `v0`, which come first.
    pub(crate) of_v0: usize,
    /// Index of the ghost in the ring.
    pub(crate) ghost: Option<usize>,
    /// Position of `v1` relative to `v0`.
    pub(crate) along: Vec3,
    /// Positions of the ring relative to `v0`.
    pub(crate) ring: [[f32; ROOM]; 3],
    /// One for the spokes at `v1`, zero for the others.
    pub(crate) of_v1: [f32; ROOM],
    /// Normals of the old spokes, twice their area long.
    pub(crate) old: [[f32; ROOM]; 3],
    /// Normals of the spokes at the new vertex, twice their area long.
    pub(crate) new: [[f32; ROOM]; 3],
    /// Weight of a boundary edge.
    pub(crate) boundary_weight: f32,
    /// Change of each spoke's quadric by the contraction.
    pub(crate) changes: [VertexQuadric; ROOM],
}

impl EdgeRing {
    pub(crate) fn new(boundary_weight: f32) -> Self {
        let empty = [[0.0; ROOM]; 3];
        Self {
            ids: [0; ROOM],
            len: 0,
            of_v0: 0,
            ghost: None,
            along: Vec3::ZERO,
            ring: empty,
            of_v1: [0.0; ROOM],
            old: empty,
            new: empty,
            boundary_weight,
            changes: [VertexQuadric::default(); ROOM],
        }
    }

    /// Returns the vertices of the edge's ring.
    #[inline(always)]
    pub(crate) fn ids(&self) -> &[u32] {
        &self.ids[..self.len]
    }

    /// Gathers the ring of an edge, or refuses an edge that must not be contracted wherever the new
    /// vertex goes.
    #[inline(always)]
    pub(crate) fn gather(
        &mut self,
        vertices: &mut Vertices,
        v0: u32,
        v1: u32,
    ) -> Result<(), Refusal> {
        vertices.refresh(v0);
        vertices.refresh(v1);
        let (ring0, ring1) = (vertices.neighbours(v0), vertices.neighbours(v1));
        let len = (ring0.len() + ring1.len()).saturating_sub(4);
        if len < 3 || ring0.len().min(ring1.len()) < 3 {
            return Err(Refusal::LastFaces);
        }
        if len > MAX_RING {
            return Err(Refusal::Valence);
        }
        self.len = len;
        self.of_v0 = ring0.len() - 2;
        // The last vertex of the first part is the first of the second. The very last is written
        // beyond the end.
        let found = write_after(&mut self.ids, 0, (vertices, v0), v1)
            && write_after(&mut self.ids, self.of_v0, (vertices, v1), v0);
        if !found {
            return Err(Refusal::NonManifold);
        }
        self.link(vertices, [v0, v1])?;
        self.load_positions(vertices, v0, v1);
        Ok(())
    }

    /// Checks the link condition [DEGN99]: the ends have no common neighbours but the wings. Copies
    /// of a vertex count as one.
    #[inline(always)]
    fn link(&self, vertices: &Vertices, ends: [u32; 2]) -> Result<(), Refusal> {
        let (first, second) = self.ids().split_at(self.of_v0 + 1);
        let is_common = match self.ids.first_chunk::<RING>() {
            Some(ids) if self.len <= RING => has_before(ids, self.of_v0 + 1..self.len),
            _ => first.iter().any(|w| second.contains(w)),
        };
        if is_common {
            return Err(Refusal::Link);
        }
        for wing in [first[0], first[self.of_v0]] {
            let wing = vertices.get(wing);
            // A wing with three faces would be left between two faces on the same vertices.
            if wing.len <= 3 && !wing.flags.any(VertexFlags::BARRED) {
                return Err(Refusal::Link);
            }
        }
        if vertices.copied.is_empty() { Ok(()) } else { self.link_of_copies(vertices, ends) }
    }

    /// Checks the link condition on the input's vertices, where copies are one: no edge may appear
    /// twice.
    fn link_of_copies(&self, vertices: &Vertices, ends: [u32; 2]) -> Result<(), Refusal> {
        let origin = |&v: &u32| vertices.origin(v);
        let mut origins: Vec<u32> = self.ids().iter().chain(&ends).map(origin).collect();
        origins.sort_unstable();
        if origins.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(Refusal::Link);
        }
        for (end, others) in [(ends[0], self.of_v0 + 1..self.len), (ends[1], 1..self.of_v0)] {
            if !vertices.is_split(end) {
                continue;
            }
            // The other end's only face would come between the wings, where a copy may have one.
            if others.is_empty() {
                return Err(Refusal::NonManifold);
            }
            let copy_of_end = |w: &u32| vertices.origin(*w) == vertices.origin(end);
            let new = self.ids[others].iter().filter(|&&w| w != GHOST);
            for &w in new {
                // Also not between copies, another of which may have the edge, and not to a vertex
                // with a long ring, which may contain dead ones.
                let unclear = vertices.is_split(w) || vertices.get(w).len == LONG;
                if unclear || vertices.neighbours(w).iter().any(copy_of_end) {
                    return Err(Refusal::NonManifold);
                }
            }
        }
        Ok(())
    }

    /// Loads the positions of the ring, and computes the old normals.
    #[inline(always)]
    fn load_positions(&mut self, vertices: &Vertices, v0: u32, v1: u32) {
        let (from, to) = (vertices.get(v0).place(), vertices.get(v1).place());
        self.along = to - from;
        for start in self.lane_starts() {
            self.load_lanes(vertices, start, from);
        }
        // Close the ring. The lanes beyond are degenerate faces.
        for x in &mut self.ring {
            x[self.len.next_multiple_of(LANES)] = x[0];
        }
        self.ghost = self.ids().iter().position(|&w| w == GHOST);
        if let Some(ghost) = self.ghost {
            self.place_ghost(ghost);
        }
        for start in self.lane_starts() {
            let (spokes, mut old) = (self.spokes(start), Row3::ZERO);
            for lane in 0..LANES {
                old.set(lane, spokes.normal(lane, self.along * spokes.of_v1[lane]));
            }
            write(&mut self.old, start, &old);
        }
        if let Some(ghost) = self.ghost {
            clear(&mut self.old, ghost, self.len);
        }
    }

    /// Loads the positions of eight vertices of the ring, and marks the spokes at `v1`.
    #[inline(always)]
    fn load_lanes(&mut self, vertices: &Vertices, start: usize, from: Vec3) {
        let first = self.ids[0];
        let ids: &mut [u32; LANES] = chunk_mut(&mut self.ids, start);
        let (len, of_v0) = ((self.len - start) as u32, self.of_v0.saturating_sub(start) as u32);
        for (lane, id) in (0..).zip(&mut *ids) {
            *id = if lane < len { *id } else { first };
        }
        let load = |lane: usize| vertices.get(ids[lane]).quadric.0[0] - from.extend(0.0);
        let [x, y, z, _] =
            transpose([load(0), load(1), load(2), load(3), load(4), load(5), load(6), load(7)]);
        write(&mut self.ring, start, &Row3 { x, y, z });
        let mut of_v1 = [0.0; LANES];
        for (lane, of_v1) in (0..).zip(&mut of_v1) {
            *of_v1 = if (lane >= of_v0) & (lane < len) { 1.0 } else { 0.0 };
        }
        *chunk_mut(&mut self.of_v1, start) = of_v1;
    }

    /// Places the ghost on the boundary vertex before it, so that its edge is an existing one.
    #[cold]
    fn place_ghost(&mut self, ghost: usize) {
        let before = (ghost + self.len - 1) % self.len;
        let beyond = self.len..=self.len.next_multiple_of(LANES);
        for x in &mut self.ring {
            x[ghost] = x[before];
            let first = x[0];
            x[beyond.clone()].fill(first);
        }
    }

    /// Returns the start index of each group of eight spokes.
    #[inline(always)]
    pub(crate) fn lane_starts(&self) -> impl Iterator<Item = usize> + use<> {
        (0..self.len).step_by(LANES)
    }

    /// Places the new vertex, relative to `v0`, and computes the new normals. Refuses if a face
    /// flips, turns by more than the limit, or loses its area.
    #[inline(always)]
    pub(crate) fn try_place(&mut self, place: Vec3) -> Result<(), Refusal> {
        for start in self.lane_starts() {
            let (spokes, mut new) = (self.spokes(start), Row3::ZERO);
            for lane in 0..LANES {
                new.set(lane, spokes.normal(lane, place));
            }
            write(&mut self.new, start, &new);
        }
        if let Some(ghost) = self.ghost {
            clear(&mut self.new, ghost, self.len);
        }
        let mut turned = 0;
        for start in self.lane_starts() {
            let (old, new) = (row3(&self.old, start), row3(&self.new, start));
            for lane in 0..LANES {
                let (old, new) = (old.get(lane), new.get(lane));
                let (turn, before) = (old.dot(new), old.dot(old));
                let least = MIN_COSINE * MIN_COSINE * before * new.dot(new);
                let kept = (turn > 0.0) & (turn * turn > least);
                turned |= u32::from(!kept & (before > 0.0));
            }
        }
        if turned == 0 { Ok(()) } else { Err(Refusal::Flip) }
    }

    /// Returns the normals of the two faces at the edge, in the order of their wings.
    #[inline(always)]
    pub(crate) fn dying_normals(&self) -> (Vec3, Vec3) {
        let (mut first, mut last) = (Vec3::ZERO, Vec3::ZERO);
        if self.ghost != Some(0) {
            first = self.along.cross(self.relative(0));
        }
        if self.ghost != Some(self.of_v0) {
            last = self.relative(self.of_v0).cross(self.along);
        }
        (first, last)
    }

    /// Computes the change of each spoke's quadric. Returns the quadric of the new vertex without
    /// boundary edges.
    #[inline(always)]
    pub(crate) fn quadric_changes(&mut self) -> VertexQuadric {
        let mut sums = [[0.0; LANES]; 9];
        for start in self.lane_starts() {
            let (old, new) = (row3(&self.old, start), row3(&self.new, start));
            let mut change = [[0.0; LANES]; 9];
            for lane in 0..LANES {
                let (now, was) = (sums_of(new.get(lane)), sums_of(old.get(lane)));
                for k in 0..9 {
                    sums[k][lane] += now[k];
                    change[k][lane] = now[k] - was[k];
                }
            }
            let [nx, ny, nz, xx, yy, zz, xy, xz, yz] = change;
            let none = [0.0; LANES];
            let (first, second) =
                (transpose_back([none, none, none, nx]), transpose_back([ny, nz, xx, yy]));
            let third = transpose_back([zz, xy, xz, yz]);
            for lane in 0..LANES {
                self.changes[start + lane] =
                    VertexQuadric([first[lane], second[lane], third[lane]]);
            }
        }
        let mut sum = [0.0; 9];
        for (sum, lanes) in sum.iter_mut().zip(&sums) {
            *sum = sum_of(lanes);
        }
        let [nx, ny, nz, xx, yy, zz, xy, xz, yz] = sum;
        VertexQuadric([
            Vec4::new(0.0, 0.0, 0.0, nx),
            Vec4::new(ny, nz, xx, yy),
            Vec4::new(zz, xy, xz, yz),
        ])
    }

    /// Returns the plane g·x = level on which the volume is preserved, relative to the middle of
    /// the edge: the sum g of all old normals, each face once, and the level. The arguments are the
    /// normals of the dying faces.
    #[inline(always)]
    pub(crate) fn volume_plane(&self, (first, last): (Vec3, Vec3)) -> (DVec3, f64) {
        let (n0, n1) = self.sums();
        let half = self.along.as_dvec3() * 0.5;
        ((n0 + n1 + first + last).as_dvec3(), (n1 - n0).as_dvec3().dot(half))
    }

    /// Returns the sums of the old normals around `v0` and around `v1`.
    #[inline(always)]
    fn sums(&self) -> (Vec3, Vec3) {
        let (mut of_v0, mut of_v1) = (Row3::ZERO, Row3::ZERO);
        for start in self.lane_starts() {
            let (old, part): (_, &Row) = (row3(&self.old, start), chunk(&self.of_v1, start));
            for lane in 0..LANES {
                let old = old.get(lane);
                of_v0.set(lane, of_v0.get(lane) + old * (1.0 - part[lane]));
                of_v1.set(lane, of_v1.get(lane) + old * part[lane]);
            }
        }
        let sum = |of: &Row3| Vec3::new(sum_of(&of.x), sum_of(&of.y), sum_of(&of.z));
        (sum(&of_v0), sum(&of_v1))
    }

    /// Returns true if the edge is at the boundary. If `v0` is one of several copies, only a
    /// boundary around `v1` counts: the other fans go on.
    #[inline(always)]
    pub(crate) fn is_open(&self, vertices: &Vertices, v0: u32) -> bool {
        match self.ghost {
            Some(at) if vertices.is_split(v0) => at == 0 || at >= self.of_v0,
            ghost => ghost.is_some(),
        }
    }

    /// Returns the boundary edges among the spokes: the index in the ring of the far end, and
    /// whether the near end is `v1`.
    #[inline(always)]
    pub(crate) fn boundary(&self) -> [(usize, bool); 2] {
        let Some(ghost) = self.ghost else { return [(0, false); 2] };
        let before = (ghost + self.len - 1) % self.len;
        let after = (ghost + 1) % self.len;
        [(before, before >= self.of_v0), (after, ghost >= self.of_v0)]
    }

    /// Returns the index in the ring of the wing of the first or second dying face.
    #[inline(always)]
    pub(crate) fn wing(&self, dying: usize) -> usize {
        if dying == 0 { 0 } else { self.of_v0 }
    }

    /// Returns the position of the ring vertex with this index, relative to `v0`.
    #[inline(always)]
    pub(crate) fn relative(&self, i: usize) -> Vec3 {
        one(&self.ring, i)
    }

    /// Returns true if a spoke is a face, and not one of the ghost's that close the ring at a
    /// boundary.
    #[inline(always)]
    pub(crate) fn is_face(&self, spoke: usize) -> bool {
        self.ghost.is_none_or(|ghost| ghost != spoke && ghost != (spoke + 1) % self.len)
    }

    /// Returns the largest squared distance of the ring and the ends from the middle of the edge.
    #[inline(always)]
    pub(crate) fn reach(&self) -> f32 {
        let half = self.along * 0.5;
        let mut reach = [half.length_squared(); LANES];
        for start in self.lane_starts() {
            let ring = row3(&self.ring, start);
            for lane in 0..LANES {
                reach[lane] = select_max(ring.get(lane).distance_squared(half), reach[lane]);
            }
        }
        let mut farthest = reach[0];
        for lane in reach {
            farthest = select_max(lane, farthest);
        }
        farthest
    }

    /// Returns the eight spokes from index `start` on.
    #[inline(always)]
    pub(crate) fn spokes(&self, start: usize) -> Spokes {
        Spokes {
            a: row3(&self.ring, start),
            b: row3(&self.ring, start + 1),
            of_v1: *chunk(&self.of_v1, start),
        }
    }
}

/// Eight spokes: the ring's vertices, the ones after them, and which end the spokes belong to.
#[derive(Clone, Copy)]
pub(crate) struct Spokes {
    pub(crate) a: Row3,
    pub(crate) b: Row3,
    pub(crate) of_v1: Row,
}

impl Spokes {
    /// Returns the normal, twice the area long, of the face with this apex.
    #[inline(always)]
    fn normal(&self, lane: usize, apex: Vec3) -> Vec3 {
        (self.a.get(lane) - apex).cross(self.b.get(lane) - apex)
    }
}

/// Returns n and n n', weighted by [`per_square`], of one face: x, y, z, xx, yy, zz, xy, xz, yz.
#[inline(always)]
fn sums_of(n: Vec3) -> [f32; 9] {
    let Vec3 { x, y, z } = n;
    let w = per_square(n.dot(n));
    [x, y, z, w * x * x, w * y * y, w * z * z, w * x * y, w * x * z, w * y * z]
}

#[inline(always)]
fn one(from: &[[f32; ROOM]; 3], i: usize) -> Vec3 {
    Vec3::new(from[0][i], from[1][i], from[2][i])
}

#[inline(always)]
pub(crate) fn chunk<T, const N: usize>(of: &[T], start: usize) -> &[T; N] {
    of[start..].first_chunk().expect("there is room beyond the end")
}

#[inline(always)]
fn chunk_mut<T, const N: usize>(of: &mut [T], start: usize) -> &mut [T; N] {
    of[start..].first_chunk_mut().expect("there is room beyond the end")
}

#[inline(always)]
pub(crate) fn row3([x, y, z]: &[[f32; ROOM]; 3], start: usize) -> Row3 {
    Row3 { x: *chunk(x, start), y: *chunk(y, start), z: *chunk(z, start) }
}

#[inline(always)]
fn write([x, y, z]: &mut [[f32; ROOM]; 3], start: usize, from: &Row3) {
    *chunk_mut(x, start) = from.x;
    *chunk_mut(y, start) = from.y;
    *chunk_mut(z, start) = from.z;
}

/// Writes the ring of `v` from the neighbour after `end` on. Returns false if `end` is not a
/// neighbour. Always copies the whole array, also beyond the ring's end: a copy of variable length
/// is a call.
#[inline(always)]
fn write_after(
    to: &mut [u32; ROOM],
    start: usize,
    (vertices, v): (&Vertices, u32),
    end: u32,
) -> bool {
    let vertex = vertices.get(v);
    let len = vertex.len as usize;
    if len > RING {
        return write_long_after(&mut to[start..], vertices.neighbours(v), end);
    }
    let Some(at) = index_in_ring(&vertex.ring, len, end) else { return false };
    let mut twice = [0; 2 * RING];
    *chunk_mut(&mut twice, 0) = vertex.ring;
    *chunk_mut(&mut twice, len) = vertex.ring;
    *chunk_mut(to, start) = *chunk::<_, RING>(&twice, at + 1);
    true
}

#[cold]
fn write_long_after(to: &mut [u32], ring: &[u32], end: u32) -> bool {
    let Some(at) = index_in(ring, end) else { return false };
    let turned = ring[at + 1..].iter().chain(&ring[..at]);
    to.iter_mut().zip(turned).for_each(|(to, &w)| *to = w);
    true
}

/// Returns true if an id in the range also occurs in the ring before it.
#[inline(always)]
fn has_before(ids: &[u32; RING], range: Range<usize>) -> bool {
    let (start, mut times) = (range.start as u32, 0);
    for &v in &ids[range] {
        for (i, &id) in (0..).zip(ids) {
            times += u32::from((id == v) & (i < start));
        }
    }
    times > 0
}

/// Clears the normals of the ghost's two faces.
fn clear(normals: &mut [[f32; ROOM]; 3], ghost: usize, len: usize) {
    for normals in normals {
        normals[ghost] = 0.0;
        normals[(ghost + len - 1) % len] = 0.0;
    }
}
