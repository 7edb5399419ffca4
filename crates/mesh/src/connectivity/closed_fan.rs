//! Connectivity around a vertex in the common case: its faces form one closed fan.

use super::{EdgeCounts, Side};
use crate::{FaceId, VertexId};

/// The star of a vertex, gathered if it is one closed fan of consistently oriented faces.
pub(super) struct ClosedFan {
    /// For each vertex, the last center it was a neighbour of, and the index in the star of the
    /// face that leaves the center towards it.
    leaves_to: Vec<(VertexId, u32)>,
    spans: [Span; ClosedFan::MAX_FACES],
    len: usize,
}

/// A face of the star, by the side that leaves the center and the side that arrives at it.
///
/// The arriving side comes from `neighbour`; `next` is the index of the face that leaves to it.
#[derive(Clone, Copy, Default)]
struct Span {
    leaving: u32,
    arriving: u32,
    neighbour: VertexId,
    next: u32,
}

impl ClosedFan {
    /// Largest star that is gathered.
    const MAX_FACES: usize = 32;

    pub(super) fn new(vertex_count: usize) -> Self {
        Self {
            leaves_to: vec![(VertexId(u32::MAX), 0); vertex_count],
            spans: [Span::default(); Self::MAX_FACES],
            len: 0,
        }
    }

    /// Gathers the star of `vertex`; returns true if it is one closed, consistently oriented fan.
    #[inline]
    pub(super) fn gather(
        &mut self,
        faces: &[[VertexId; 3]],
        star: &[FaceId],
        vertex: VertexId,
    ) -> bool {
        self.len = star.len();
        if star.len() > Self::MAX_FACES {
            return false;
        }
        let mut twice = false;
        for (i, &face) in star.iter().enumerate() {
            let corners = faces[face.index()];
            // Without branches, which would be mispredicted two times out of three.
            let k = usize::from(corners[1] == vertex) + 2 * usize::from(corners[2] == vertex);
            let [k1, k2] = [[1, 2], [2, 0], [0, 1]][k];
            let slot = &mut self.leaves_to[corners[k1].index()];
            twice |= slot.0 == vertex;
            *slot = (vertex, i as u32);
            self.spans[i] = Span {
                leaving: Side::new(face, k).0,
                arriving: Side::new(face, k2).0,
                neighbour: corners[k2],
                next: 0,
            };
        }
        !twice && self.is_cycle(vertex)
    }

    /// Links each face to the next; returns true if they form a single cycle.
    #[inline]
    fn is_cycle(&mut self, vertex: VertexId) -> bool {
        let spans = &mut self.spans[..self.len];
        for span in spans.iter_mut() {
            let (center, i) = self.leaves_to[span.neighbour.index()];
            if center != vertex {
                return false;
            }
            span.next = i;
        }
        let mut at = 0;
        for steps in 1..=spans.len() {
            at = spans[at].next as usize;
            if at == 0 {
                return steps == spans.len();
            }
        }
        false
    }

    /// Records the twins at the vertex, and counts the edges whose lower end it is.
    #[inline]
    pub(super) fn record(&self, vertex: VertexId, twins: &mut [u32], edges: &mut EdgeCounts) {
        let spans = &self.spans[..self.len];
        for span in spans {
            let leaving = spans[span.next as usize].leaving;
            twins[span.arriving as usize] = leaving;
            twins[leaving as usize] = span.arriving;
            edges.all += usize::from(vertex < span.neighbour);
        }
    }
}
