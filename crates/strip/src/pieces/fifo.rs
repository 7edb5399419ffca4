//! The vertex cache of a GPU, as the books have it: what came first goes first.

use meshlod_mesh::VertexId;

/// The vertices that have come into a cache, in order. It can go back, so that what would be sent can be tried.
#[derive(Clone, Debug)]
pub(crate) struct Fifo {
    /// How many of the last it holds.
    size: usize,
    came: Vec<Came>,
    /// By vertex: one more than its last place in `came`, or 0.
    last: Vec<u32>,
}

/// A vertex that was not in the cache and came in.
#[derive(Clone, Copy, Debug)]
struct Came {
    vertex: VertexId,
    /// What `last` said of it before.
    last: u32,
}

impl Fifo {
    /// An empty cache for `size` of `vertex_count` vertices.
    pub(crate) fn new(size: usize, vertex_count: usize) -> Self {
        Self { size, came: Vec::new(), last: vec![0; vertex_count] }
    }

    /// Sends a vertex to be drawn.
    #[inline]
    pub(crate) fn send(&mut self, vertex: VertexId) {
        let last = self.last[vertex.index()];
        if last == 0 || self.came.len() - last as usize >= self.size {
            self.came.push(Came { vertex, last });
            self.last[vertex.index()] = self.came.len() as u32;
        }
    }

    /// How many vertices came in so far: each was transformed.
    #[inline]
    pub(crate) fn misses(&self) -> usize {
        self.came.len()
    }

    /// Forgets all that came in after the first `misses`.
    pub(crate) fn go_back(&mut self, misses: usize) {
        for Came { vertex, last } in self.came.drain(misses..).rev() {
            self.last[vertex.index()] = last;
        }
    }

    /// The last `count` vertices that came in.
    pub(crate) fn latest(&self, count: usize) -> impl Iterator<Item = VertexId> + '_ {
        self.came[self.came.len().saturating_sub(count)..].iter().map(|came| came.vertex)
    }
}
