//! An index buffer in which strips come and go.

use std::collections::BTreeMap;
use std::ops::Range;

use meshlod_mesh::VertexId;

use crate::strips::Strips;

/// Indices of strips, each followed by a restart; places that are free are full of restarts.
#[derive(Clone, Debug, Default)]
pub(super) struct IndexBuffer {
    indices: Vec<u32>,
    /// Starts of free places by length, restarts included.
    free: BTreeMap<usize, Vec<usize>>,
    used: usize,
    changed: Vec<Range<usize>>,
}

impl IndexBuffer {
    /// Starts a new list of changes.
    pub(super) fn begin(&mut self) {
        self.changed.clear();
    }

    /// Removes all strips.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Writes a strip at the smallest place that holds it, or at the end, and returns where, without
    /// the restart.
    pub(super) fn add(&mut self, strip: &[VertexId]) -> Range<usize> {
        let size = strip.len() + 1;
        let start = self.take(size).unwrap_or(self.indices.len());
        let end = start + size;
        self.indices.resize(self.indices.len().max(end), Strips::RESTART);
        for (index, vertex) in self.indices[start..].iter_mut().zip(strip) {
            *index = vertex.0;
        }
        self.used += size;
        self.changed.push(start..end);
        start..end - 1
    }

    /// Removes a strip from its place.
    pub(super) fn remove(&mut self, place: Range<usize>) {
        let size = place.len() + 1;
        self.used -= size;
        self.changed.push(place.clone());
        self.free.entry(size).or_default().push(place.start);
        self.indices[place].fill(Strips::RESTART);
    }

    pub(super) fn indices(&self) -> &[u32] {
        &self.indices
    }

    pub(super) fn changed(&self) -> &[Range<usize>] {
        &self.changed
    }

    /// Returns the number of entries, free ones included.
    pub(super) fn len(&self) -> usize {
        self.indices.len()
    }

    /// Returns the number of entries of strips and the restarts after them.
    pub(super) fn used(&self) -> usize {
        self.used
    }

    /// Takes a free place of at least this size, and returns the rest of it to the free list.
    fn take(&mut self, size: usize) -> Option<usize> {
        let (&found, starts) = self.free.range_mut(size..).next()?;
        let start = starts.pop();
        if starts.is_empty() {
            self.free.remove(&found);
        }
        let start = start?;
        if found > size {
            self.free.entry(found - size).or_default().push(start + size);
        }
        Some(start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_place_is_taken_and_its_rest_kept() {
        let mut buffer = IndexBuffer::default();
        let strip =
            |count: u32, first: u32| (first..first + count).map(VertexId).collect::<Vec<_>>();
        let places = [5, 3, 9].map(|count| buffer.add(&strip(count, 10 * count)));
        assert_eq!(places, [0..5, 6..9, 10..19]);
        buffer.begin();
        buffer.remove(0..5);
        buffer.remove(10..19);
        assert_eq!((buffer.used(), buffer.len()), (4, 20));
        assert_eq!(buffer.add(&strip(3, 0)), 0..3);
        assert_eq!(buffer.add(&strip(6, 0)), 10..16);
        // Two entries are left of the first place, too few for a strip.
        assert_eq!(buffer.add(&strip(3, 7)), 20..23);
        assert_eq!(buffer.changed(), [0..5, 10..19, 0..4, 10..17, 20..24]);
        let r = Strips::RESTART;
        assert_eq!(buffer.indices()[..12], [0, 1, 2, r, r, r, 30, 31, 32, r, 0, 1]);
        assert_eq!(buffer.indices()[16..], [r, r, r, r, 7, 8, 9, r]);
    }
}
