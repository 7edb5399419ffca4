//! The faces of the input with the vertices of cuts at their corners.
//!
//! The current surface is what becomes of the input's faces when each corner is the vertex that it
//! has been contracted into. A cut parts the faces of a vertex. So the corners on its far side are
//! moved to the copy of that vertex.

use rustc_hash::FxHashMap;

use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::setup::vertex_order::is_face;

/// Corners of the input's faces.
pub(crate) struct HandleFaces {
    all: Vec<[u32; 3]>,
    /// Which corners each vertex has, from the first cut on.
    corners: Option<CornersByVertex>,
}

/// For each vertex, the vertices contracted into it and the faces at each of them.
struct CornersByVertex {
    /// Vertices that have been contracted into one, in a circle.
    next: Vec<u32>,
    /// Start of each vertex's faces.
    starts: Vec<u32>,
    faces: Vec<u32>,
    /// Faces whose corners have been moved to vertices of cuts.
    moved: FxHashMap<u32, Vec<u32>>,
}

impl HandleFaces {
    pub(crate) fn new(all: Vec<[u32; 3]>) -> Self {
        Self { all, corners: None }
    }

    pub(crate) fn all(&self) -> &[[u32; 3]] {
        &self.all
    }

    /// Notes that a vertex has been contracted into another.
    #[inline(always)]
    pub(crate) fn merge(&mut self, kept: u32, gone: u32) {
        if let Some(corners) = &mut self.corners {
            corners.next.swap(kept as usize, gone as usize);
        }
    }

    /// Moves to `copy` the corners at `v` of the faces in which a vertex that `is_far` follows.
    ///
    /// Cost: O(n) for the first time, n = faces; then the faces of all vertices contracted into `v`.
    pub(crate) fn part(
        &mut self,
        vertices: &mut Vertices<'_>,
        [v, copy]: [u32; 2],
        is_far: impl Fn(u32) -> bool,
    ) {
        let corners = self.corners.get_or_insert_with(|| CornersByVertex::new(vertices, &self.all));
        let mut moved = Vec::new();
        for leaf in corners.leaves(v) {
            for &face in corners.faces_at(leaf) {
                let of_input = self.all[face as usize];
                // The corner may have been moved before.
                let Some(at) = of_input.iter().position(|&corner| corner == leaf) else { continue };
                let now = of_input.map(|corner| vertices.live_vertex(corner));
                if is_face(now) && is_far(now[(at + 1) % 3]) {
                    self.all[face as usize][at] = copy;
                    moved.push(face);
                }
            }
        }
        corners.moved.insert(copy, moved);
    }
}

impl CornersByVertex {
    fn new(vertices: &mut Vertices<'_>, faces: &[[u32; 3]]) -> Self {
        let count = vertices.all.len();
        let mut next: Vec<u32> = (0..count as u32).collect();
        for v in 0..count as u32 {
            let live = vertices.live_vertex(v);
            if live != v {
                next.swap(live as usize, v as usize);
            }
        }
        let mut starts = vec![0u32; count + 1];
        for &v in faces.as_flattened() {
            starts[v as usize + 1] += 1;
        }
        for v in 0..count {
            starts[v + 1] += starts[v];
        }
        let mut ends = starts.clone();
        let mut at = vec![0; 3 * faces.len()];
        for (face, corners) in (0..).zip(faces) {
            for &v in corners {
                at[ends[v as usize] as usize] = face;
                ends[v as usize] += 1;
            }
        }
        Self { next, starts, faces: at, moved: FxHashMap::default() }
    }

    /// Returns the vertices that have been contracted into `v`, and `v` itself.
    fn leaves(&self, v: u32) -> Vec<u32> {
        let mut leaves = vec![v];
        let mut at = self.next[v as usize];
        while at != v {
            leaves.push(at);
            at = self.next[at as usize];
        }
        leaves
    }

    /// Returns the faces that have had a corner at a vertex of the input or of a cut.
    fn faces_at(&self, leaf: u32) -> &[u32] {
        match self.moved.get(&leaf) {
            Some(moved) => moved,
            None => {
                let [start, end] = [leaf, leaf + 1].map(|v| self.starts[v as usize] as usize);
                &self.faces[start..end]
            }
        }
    }
}
