//! Index buffers of strips that change, rewritten only where they change.

use std::ops::Range;

use meshlod_mesh::VertexId;

use super::LiveStrips;
use super::index_buffer::IndexBuffer;
use crate::verify::has_three_corners;

/// Indices of [`LiveStrips`] for one draw call a set, with [`Strips::RESTART`] after each strip.
///
/// Sets are what cannot be drawn together, such as materials. Strips keep their places while they
/// do not change; between them are restarts, where others were, which draw nothing: at most an
/// eighth as many as indices, and a few more.
///
/// [`Strips::RESTART`]: crate::Strips::RESTART
#[derive(Clone, Debug)]
pub struct StripIndices {
    sets: Vec<IndexBuffer>,
    /// Set and place of each strip by id; `None` for ids that are free.
    strips: Vec<Option<(usize, Range<usize>)>>,
    free_ids: Vec<u32>,
    /// Strip of the triangle in each slot.
    strip_of: Vec<Option<u32>>,
    /// Number of updates of the strips that were followed.
    updates: u64,
}

/// Maximum number of unused entries, in addition to an eighth of the used ones.
const SPARE: usize = 64;

impl StripIndices {
    /// Writes the current strips into `sets` index buffers; `set_of` tells the set of a strip by one
    /// of its vertices.
    ///
    /// From now on the strips list what they change, for a few percent more work.
    ///
    /// Cost: linear.
    /// # Panics
    /// If a strip is in none of the sets.
    pub fn new(strips: &mut LiveStrips, sets: usize, set_of: impl Fn(VertexId) -> usize) -> Self {
        let mut this = Self {
            sets: vec![IndexBuffer::default(); sets],
            strips: Vec::new(),
            free_ids: Vec::new(),
            strip_of: Vec::new(),
            updates: 0,
        };
        strips.cover.touched.get_or_insert_default();
        this.write_all(strips, &set_of);
        this
    }

    /// Follows the last update of the strips; if others were skipped, writes everything anew.
    ///
    /// Cost: the length of the strips that have changed, amortized.
    /// # Panics
    /// If a strip is in none of the sets.
    pub fn update(&mut self, strips: &LiveStrips, set_of: impl Fn(VertexId) -> usize) {
        self.sets.iter_mut().for_each(IndexBuffer::begin);
        if strips.updates == self.updates {
            return;
        }
        let touched = strips.cover.touched.as_ref().filter(|_| strips.updates == self.updates + 1);
        let Some(touched) = touched else { return self.write_all(strips, &set_of) };
        self.strip_of.resize(strips.faces.len(), None);
        // First all old strips, since the triangles of one may now be in several.
        for &slot in touched.nodes() {
            self.remove(slot as usize);
        }
        for &slot in touched.nodes() {
            self.write(strips, slot as usize, &set_of);
        }
        self.updates = strips.updates;
        let [used, all] = [IndexBuffer::used, IndexBuffer::len]
            .map(|count| self.sets.iter().map(count).sum::<usize>());
        if all > used + used / 8 + SPARE {
            self.write_all(strips, &set_of);
        }
    }

    /// Returns the number of sets.
    pub fn sets(&self) -> usize {
        self.sets.len()
    }

    /// Returns the indices of a set.
    ///
    /// # Panics
    /// `set` is not below [`sets`](Self::sets).
    pub fn indices(&self, set: usize) -> &[u32] {
        self.sets[set].indices()
    }

    /// Returns the ranges of a set's indices that the last update has written, in the order of
    /// writing; they may overlap.
    ///
    /// # Panics
    /// As for [`indices`](Self::indices).
    pub fn changed(&self, set: usize) -> &[Range<usize>] {
        self.sets[set].changed()
    }

    fn write_all(&mut self, strips: &LiveStrips, set_of: &impl Fn(VertexId) -> usize) {
        self.sets.iter_mut().for_each(IndexBuffer::clear);
        self.strips.clear();
        self.free_ids.clear();
        self.strip_of.clear();
        self.strip_of.resize(strips.faces.len(), None);
        for slot in 0..strips.faces.len() {
            self.write(strips, slot, set_of);
        }
        self.updates = strips.updates;
    }

    /// Removes the strip that had the triangle in a slot, unless that has been done.
    fn remove(&mut self, slot: usize) {
        let Some(id) = self.strip_of[slot].take() else { return };
        if let Some((set, place)) = self.strips[id as usize].take() {
            self.sets[set].remove(place);
            self.free_ids.push(id);
        }
    }

    /// Writes the strip that has the triangle in a slot, unless that has been done.
    fn write(&mut self, strips: &LiveStrips, slot: usize, set_of: &impl Fn(VertexId) -> usize) {
        let LiveStrips { faces, cover, .. } = strips;
        if self.strip_of[slot].is_some() || !has_three_corners(&faces[slot]) {
            return;
        }
        let mut vertices = Vec::new();
        let end = cover.draw_through(faces, slot, &mut vertices);
        let set = set_of(vertices[0]);
        let place = self.sets[set].add(&vertices);
        let id = self.free_ids.pop().unwrap_or_else(|| {
            self.strips.push(None);
            self.strips.len() as u32 - 1
        });
        self.strips[id as usize] = Some((set, place));
        cover.path(end).for_each(|(slot, _)| self.strip_of[slot] = Some(id));
    }
}

#[cfg(test)]
mod tests;
