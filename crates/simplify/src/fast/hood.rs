//! What is around an edge, gathered once for all that a contraction asks.
//!
//! ```text
//!        x1 = ids[0]                  The ring of what becomes of v0 and v1: first the vertices
//!       /  | \                        around v0, from wing to wing, then the others around v1.
//!   x2 —— v0 — v1 —— y                Spoke i is the face of ids[i], ids[i + 1] and v0, or v1 for
//!       \  | /                        the last ones. Ghosts have their places too, and no area.
//!        xk = ids[of_v0]
//! ```

use glam::{Vec3, Vec4};

use crate::fast::lanes::{LANES, Lanes3, transpose};
use crate::fast::ring::{GHOST, MOST, Vertices, place_in};
use crate::fast::vertex::{Flags, Star, Vertex};
use crate::refusal::Refusal;

/// Room for a ring and the lanes beyond its end.
pub(super) const ROOM: usize = MOST + 2 * LANES;

/// The least cosine between a face's normal before and after, as in the general engine.
const LEAST_COSINE: f32 = 0.2;

/// What is around an edge.
pub(super) struct Hood {
    /// The ring.
    pub(super) ids: [u32; ROOM],
    /// How many of them there are.
    pub(super) len: usize,
    /// How many spokes are v0's: those before.
    pub(super) of_v0: usize,
    /// The ghost's place in the ring.
    pub(super) ghost: Option<usize>,
    /// v1 as seen from v0.
    pub(super) along: Vec3,
    /// The ring as seen from v0.
    pub(super) ring: [[f32; ROOM]; 3],
    /// One where a spoke is v1's.
    pub(super) of_v1: [f32; ROOM],
    /// Twice the area of each spoke along its normal, now.
    pub(super) old: [[f32; ROOM]; 3],
    /// The same with the new vertex.
    pub(super) new: [[f32; ROOM]; 3],
    /// What a contraction changes in the star of each spoke.
    pub(super) changes: [Star; ROOM],
}

impl Hood {
    pub(super) fn new() -> Self {
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
            changes: [Star::default(); ROOM],
        }
    }

    /// The ring's vertices.
    #[inline(always)]
    pub(super) fn ids(&self) -> &[u32] {
        &self.ids[..self.len]
    }

    /// Gathers the ring of an edge, or says why it may not be contracted wherever its vertex goes.
    #[inline(always)]
    pub(super) fn gather(
        &mut self,
        vertices: &mut Vertices,
        v0: u32,
        v1: u32,
    ) -> Result<(), Refusal> {
        vertices.bring_up(v0);
        vertices.bring_up(v1);
        let (ring0, ring1) = (vertices.settled(v0), vertices.settled(v1));
        let len = (ring0.len() + ring1.len()).saturating_sub(4);
        if len < 3 || ring0.len().min(ring1.len()) < 3 {
            return Err(Refusal::LastFaces);
        }
        if len > MOST {
            return Err(Refusal::Valence);
        }
        let (Some(at0), Some(at1)) = (place_in(ring0, v1), place_in(ring1, v0)) else {
            return Err(Refusal::NonManifold);
        };
        self.len = len;
        self.of_v0 = ring0.len() - 2;
        let mut next = 0;
        for part in [&ring0[at0 + 1..], &ring0[..at0]] {
            for &w in part {
                self.ids[next] = w;
                next += 1;
            }
        }
        // The first wing is there already; the second comes last and is written over.
        next -= 1;
        for part in [&ring1[at1 + 1..], &ring1[..at1]] {
            for &w in part {
                self.ids[next] = w;
                next += 1;
            }
        }
        self.link(vertices, [v0, v1])?;
        self.see(vertices, v0, v1);
        Ok(())
    }

    /// The link condition [DEGN99]: no common neighbours but the wings. Copies of a vertex are one.
    #[inline(always)]
    fn link(&self, vertices: &Vertices, ends: [u32; 2]) -> Result<(), Refusal> {
        let (first, second) = self.ids().split_at(self.of_v0 + 1);
        if first.iter().any(|w| second.contains(w)) {
            return Err(Refusal::Link);
        }
        for wing in [first[0], first[self.of_v0]] {
            let wing = vertices.get(wing);
            // A wing of three faces would be left between two on the same vertices.
            if wing.len <= 3 && !wing.flags.any(Flags::BARRED) {
                return Err(Refusal::Link);
            }
        }
        if vertices.copied.is_empty() { Ok(()) } else { self.link_of_copies(vertices, ends) }
    }

    /// As the input has it, where copies are one vertex: no edge may come to be twice.
    fn link_of_copies(&self, vertices: &Vertices, ends: [u32; 2]) -> Result<(), Refusal> {
        let origin = |&v: &u32| vertices.origin(v);
        let mut origins: Vec<u32> = self.ids().iter().chain(&ends).map(origin).collect();
        origins.sort_unstable();
        if origins.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(Refusal::Link);
        }
        for (end, others) in [(ends[0], self.of_v0 + 1..self.len), (ends[1], 1..self.of_v0)] {
            if !vertices.get(end).flags.any(Flags::SPLIT) {
                continue;
            }
            let copy_of_end = |w: &u32| vertices.origin(*w) == vertices.origin(end);
            let new = self.ids[others].iter().filter(|&&w| w != GHOST);
            for &w in new {
                // Nor between copies, of which others may have the edge, nor to a hub, whose list may
                // name dead vertices.
                let vertex = vertices.get(w);
                let unclear = vertex.flags.any(Flags::SPLIT) || vertex.flags.any(Flags::BARRED);
                if unclear || vertices.settled(w).iter().any(copy_of_end) {
                    return Err(Refusal::NonManifold);
                }
            }
        }
        Ok(())
    }

    /// Looks up where the ring is, and what its faces are now.
    #[inline(always)]
    fn see(&mut self, vertices: &Vertices, v0: u32, v1: u32) {
        let (from, to) = (vertices.get(v0).place(), vertices.get(v1).place());
        self.along = to - from;
        self.ghost = None;
        let [x, y, z] = &mut self.ring;
        for (i, &w) in self.ids[..self.len].iter().enumerate() {
            let seen = vertices.get(w).place() - from;
            (x[i], y[i], z[i]) = (seen.x, seen.y, seen.z);
            self.of_v1[i] = if i < self.of_v0 { 0.0 } else { 1.0 };
            if w == GHOST {
                self.ghost = Some(i);
            }
        }
        // The ghost lies on the boundary: an edge to it is one that there is.
        if let Some(ghost) = self.ghost {
            let before = (ghost + self.len - 1) % self.len;
            let [x, y, z] = &mut self.ring;
            (x[ghost], y[ghost], z[ghost]) = (x[before], y[before], z[before]);
        }
        // The ring closes; the lanes beyond are faces of one point.
        for i in self.len..=self.len.next_multiple_of(LANES) {
            let [x, y, z] = &mut self.ring;
            (x[i], y[i], z[i]) = (x[0], y[0], z[0]);
            self.of_v1[i] = 0.0;
        }
        let mut start = 0;
        while start < self.len {
            let apex = Lanes3::all(self.along).by(Vec4::from_slice(&self.of_v1[start..]));
            let normal = self.normal(start, apex);
            store(&mut self.old, start, normal);
            start += LANES;
        }
        if let Some(ghost) = self.ghost {
            clear(&mut self.old, ghost, self.len);
        }
    }

    /// The normals of eight spokes with this apex.
    #[inline(always)]
    fn normal(&self, start: usize, apex: Lanes3) -> Lanes3 {
        (load(&self.ring, start) - apex).cross(load(&self.ring, start + 1) - apex)
    }

    /// Puts the new vertex at `place`, as seen from v0. Whether no face turns over, or by more than a
    /// limit, or loses its area.
    #[inline(always)]
    pub(super) fn put(&mut self, place: Vec3) -> Result<(), Refusal> {
        let apex = Lanes3::all(place);
        let mut start = 0;
        while start < self.len {
            let new = self.normal(start, apex);
            store(&mut self.new, start, new);
            start += LANES;
        }
        if let Some(ghost) = self.ghost {
            clear(&mut self.new, ghost, self.len);
        }
        let mut turned = false;
        let mut start = 0;
        while start < self.len {
            let (old, new) = (load(&self.old, start), load(&self.new, start));
            let (turn, before) = (old.dot(new), old.dot(old));
            let least = LEAST_COSINE * LEAST_COSINE * before * new.dot(new);
            let kept = turn.cmpgt(Vec4::ZERO) & (turn * turn).cmpgt(least);
            turned |= (!kept & before.cmpgt(Vec4::ZERO)).any();
            start += LANES;
        }
        if turned { Err(Refusal::Flip) } else { Ok(()) }
    }

    /// The dying faces' normals, in the order of the wings they have.
    #[inline(always)]
    pub(super) fn dying(&self) -> (Vec3, Vec3) {
        let (mut first, mut last) = (Vec3::ZERO, Vec3::ZERO);
        if self.ghost != Some(0) {
            first = self.along.cross(self.seen(0));
        }
        if self.ghost != Some(self.of_v0) {
            last = self.seen(self.of_v0).cross(self.along);
        }
        (first, last)
    }

    /// What each spoke's star becomes, less what it was, and the new vertex's star but for boundaries.
    #[inline(always)]
    pub(super) fn change(&mut self) -> Star {
        let mut sum = Star::default();
        let mut start = 0;
        while start < self.len {
            let (old, new) = (load(&self.old, start), load(&self.new, start));
            let (n, was) = (faces(new), faces(old));
            for lane in 0..LANES {
                sum.add(&n[lane]);
                let mut change = n[lane];
                change.take(&was[lane]);
                self.changes[start + lane] = change;
            }
            start += LANES;
        }
        sum
    }

    /// The sums of the old normals around v0 and around v1.
    #[inline(always)]
    pub(super) fn sums(&self) -> (Vec3, Vec3) {
        let (mut of_v0, mut of_v1) = (Vec3::ZERO, Vec3::ZERO);
        for i in 0..self.of_v0 {
            of_v0 += one(&self.old, i);
        }
        for i in self.of_v0..self.len {
            of_v1 += one(&self.old, i);
        }
        (of_v0, of_v1)
    }

    /// Whether the surface ends here. Around a vertex that stands for one fan of several it ends only
    /// where it does around the other end: the other fans go on.
    #[inline(always)]
    pub(super) fn is_open(&self, end0: &Vertex) -> bool {
        match self.ghost {
            Some(at) if end0.flags.any(Flags::SPLIT) => at == 0 || at >= self.of_v0,
            ghost => ghost.is_some(),
        }
    }

    /// The boundary edges among the spokes: where in the ring they end, from which apex before.
    #[inline(always)]
    pub(super) fn boundary(&self) -> [(usize, bool); 2] {
        let Some(ghost) = self.ghost else { return [(0, false); 2] };
        let before = (ghost + self.len - 1) % self.len;
        let after = (ghost + 1) % self.len;
        [(before, before >= self.of_v0), (after, ghost >= self.of_v0)]
    }

    /// A vertex of the ring as seen from v0.
    #[inline(always)]
    pub(super) fn seen(&self, i: usize) -> Vec3 {
        one(&self.ring, i)
    }

    /// Whether a spoke is a face, none of the ghost's.
    #[inline(always)]
    pub(super) fn is_face(&self, spoke: usize) -> bool {
        self.ghost.is_none_or(|ghost| ghost != spoke && ghost != (spoke + 1) % self.len)
    }

    /// The farthest of the ring and the ends from the middle of the edge, squared.
    #[inline(always)]
    pub(super) fn reach(&self) -> f32 {
        let half = self.along * 0.5;
        let mut reach = half.length_squared();
        for i in 0..self.len {
            if self.ghost != Some(i) {
                reach = reach.max(self.seen(i).distance_squared(half));
            }
        }
        reach
    }
}

/// The stars of four faces by their normals.
#[inline(always)]
fn faces(Lanes3 { x, y, z }: Lanes3) -> [Star; LANES] {
    let first = transpose(Vec4::ZERO, Vec4::ZERO, Vec4::ZERO, x);
    let second = transpose(y, z, x * x, y * y);
    let third = transpose(z * z, x * y, x * z, y * z);
    [
        Star([first[0], second[0], third[0]]),
        Star([first[1], second[1], third[1]]),
        Star([first[2], second[2], third[2]]),
        Star([first[3], second[3], third[3]]),
    ]
}

#[inline(always)]
fn one(from: &[[f32; ROOM]; 3], i: usize) -> Vec3 {
    Vec3::new(from[0][i], from[1][i], from[2][i])
}

#[inline(always)]
pub(super) fn load(from: &[[f32; ROOM]; 3], start: usize) -> Lanes3 {
    let [x, y, z] = from;
    let at = |of: &[f32; ROOM]| Vec4::from_slice(&of[start..]);
    Lanes3 { x: at(x), y: at(y), z: at(z) }
}

#[inline(always)]
fn store(to: &mut [[f32; ROOM]; 3], start: usize, from: Lanes3) {
    let [x, y, z] = to;
    from.x.write_to_slice(&mut x[start..]);
    from.y.write_to_slice(&mut y[start..]);
    from.z.write_to_slice(&mut z[start..]);
}

/// The ghost's faces have no area.
fn clear(normals: &mut [[f32; ROOM]; 3], ghost: usize, len: usize) {
    for normals in normals {
        normals[ghost] = 0.0;
        normals[(ghost + len - 1) % len] = 0.0;
    }
}
