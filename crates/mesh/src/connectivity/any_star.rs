//! Connectivity around a vertex in the general case: any number of fans, boundary and non-manifold
//! edges.

use super::{BOUNDARY, Connectivity, EdgeCounts, Marks, NON_MANIFOLD, Side};
use crate::{FaceId, VertexId};

impl Connectivity {
    /// Finds the edges and fans at one vertex by sorting the sides at it by neighbour.
    pub(super) fn connect(
        &mut self,
        faces: &[[VertexId; 3]],
        vertex: VertexId,
        scratch: &mut Scratch,
    ) {
        let range =
            self.star_start[vertex.index()] as usize..self.star_start[vertex.index() + 1] as usize;
        let star = &self.star[range];
        scratch.gather(faces, star, vertex);
        let mut fans = star.len();
        let mut rest = scratch.spokes.as_slice();
        while let Some(&first) = rest.first() {
            let run = rest.iter().take_while(|s| s.neighbour() == first.neighbour()).count();
            let (spokes, after) = rest.split_at(run);
            rest = after;
            let marks = &mut self.marks[vertex.index()];
            match spokes {
                [_] => marks.0 |= Marks::BOUNDARY,
                [a, b] => fans -= usize::from(scratch.fans.join(a.local(), b.local())),
                _ => marks.0 |= Marks::NON_MANIFOLD_EDGE,
            }
            // Both ends of an edge visit it; the lower one records it.
            if vertex < first.neighbour() {
                record(spokes, star, faces, vertex, &mut self.twins, &mut self.edges);
            }
        }
        if fans > 1 {
            self.marks[vertex.index()].0 |= Marks::PINCHED;
        }
    }
}

/// A side at the center of a star: its other end, the index of its face in the star, and whether it
/// leaves or arrives. One word, so that sides sort by neighbour, then by face.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Spoke(u64);

impl Spoke {
    #[inline]
    fn new(neighbour: VertexId, local: usize, leaves: bool) -> Self {
        Self(u64::from(neighbour.0) << 32 | (local as u64) << 1 | u64::from(leaves))
    }

    #[inline]
    fn neighbour(self) -> VertexId {
        VertexId((self.0 >> 32) as u32)
    }

    #[inline]
    fn local(self) -> usize {
        (self.0 as u32 >> 1) as usize
    }

    #[inline]
    fn leaves(self) -> bool {
        self.0 & 1 != 0
    }

    /// Returns the spoke as a side of its face.
    #[inline]
    fn side(self, star: &[FaceId], faces: &[[VertexId; 3]], vertex: VertexId) -> Side {
        let face = star[self.local()];
        let k = corner_of(faces[face.index()], vertex);
        Side::new(face, if self.leaves() { k } else { (k + 2) % 3 })
    }
}

/// Working memory for one star after another.
#[derive(Default)]
pub(super) struct Scratch {
    spokes: Vec<Spoke>,
    fans: Fans,
}

impl Scratch {
    fn gather(&mut self, faces: &[[VertexId; 3]], star: &[FaceId], vertex: VertexId) {
        self.spokes.clear();
        self.fans.reset(star.len());
        for (local, face) in star.iter().enumerate() {
            let face = faces[face.index()];
            let k = corner_of(face, vertex);
            self.spokes.push(Spoke::new(face[(k + 1) % 3], local, true));
            self.spokes.push(Spoke::new(face[(k + 2) % 3], local, false));
        }
        self.spokes.sort_unstable();
    }
}

/// Fans of a star: a union-find over the indices of its faces.
#[derive(Default)]
struct Fans(Vec<u32>);

impl Fans {
    fn reset(&mut self, count: usize) {
        self.0.clear();
        self.0.extend(0..count as u32);
    }

    /// Joins the fans of two faces; returns false if they are one already.
    fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b) as u32;
        a != b
    }

    fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] as usize != i {
            self.0[i] = self.0[self.0[i] as usize];
            i = self.0[i] as usize;
        }
        i
    }
}

/// Records the twins of one edge, and counts it.
fn record(
    spokes: &[Spoke],
    star: &[FaceId],
    faces: &[[VertexId; 3]],
    vertex: VertexId,
    twins: &mut [u32],
    edges: &mut EdgeCounts,
) {
    edges.all += 1;
    let side = |spoke: Spoke| spoke.side(star, faces, vertex).0;
    match spokes {
        &[a] => {
            edges.boundary += 1;
            twins[side(a) as usize] = BOUNDARY;
        }
        &[a, b] => {
            edges.inconsistent += usize::from(a.leaves() == b.leaves());
            let (a, b) = (side(a), side(b));
            twins[a as usize] = b;
            twins[b as usize] = a;
        }
        many => {
            edges.non_manifold += 1;
            for &spoke in many {
                twins[side(spoke) as usize] = NON_MANIFOLD;
            }
        }
    }
}

/// Returns the corner of a face that is at the vertex.
#[inline]
fn corner_of(face: [VertexId; 3], vertex: VertexId) -> usize {
    if face[0] == vertex {
        0
    } else if face[1] == vertex {
        1
    } else {
        2
    }
}
