//! A first-in, first-out model of a GPU's vertex cache.

use meshlod_mesh::VertexId;

/// First-in, first-out vertex cache with undo, so that runs can be tried before they are sent.
#[derive(Clone, Debug)]
pub(crate) struct FifoCache {
    /// Number of entries.
    size: usize,
    missed: Vec<Miss>,
    /// One more than the index in `missed` of each vertex's last miss; 0 for none.
    last: Vec<u32>,
}

/// A vertex that entered the cache.
#[derive(Clone, Copy, Debug)]
struct Miss {
    vertex: VertexId,
    /// Former value of `last`, for undo.
    last: u32,
}

impl FifoCache {
    /// Creates an empty cache of `size` entries for `vertex_count` vertices.
    pub(crate) fn new(size: usize, vertex_count: usize) -> Self {
        Self { size, missed: Vec::new(), last: vec![0; vertex_count] }
    }

    /// Sends a vertex to be drawn.
    #[inline]
    pub(crate) fn send(&mut self, vertex: VertexId) {
        let last = self.last[vertex.index()];
        if last == 0 || self.missed.len() - last as usize >= self.size {
            self.missed.push(Miss { vertex, last });
            self.last[vertex.index()] = self.missed.len() as u32;
        }
    }

    /// Returns the number of misses so far, each a vertex transformed.
    #[inline]
    pub(crate) fn misses(&self) -> usize {
        self.missed.len()
    }

    /// Undoes all misses after the first `misses`.
    pub(crate) fn go_back(&mut self, misses: usize) {
        for Miss { vertex, last } in self.missed.drain(misses..).rev() {
            self.last[vertex.index()] = last;
        }
    }

    /// Lists the last `count` vertices that entered the cache.
    pub(crate) fn latest(&self, count: usize) -> impl Iterator<Item = VertexId> + '_ {
        self.missed[self.missed.len().saturating_sub(count)..].iter().map(|miss| miss.vertex)
    }
}
