//! Merging of STL facet corners at the same position into vertices.

use std::collections::hash_map::RandomState;
use std::hash::BuildHasher;

use meshlod_mesh::VertexId;

/// Welded vertices, with a hash table to find them by position.
///
/// A table of bare ids takes a fifth of the memory of a hash map that stores the positions again,
/// and looks up the dragon's 2.6 M corners in about four fifths of its time.
pub(super) struct Welder {
    /// Positions of the vertices, in order of appearance.
    pub positions: Vec<[f64; 3]>,
    /// Open-addressing table with a power-of-two number of slots, at most half full.
    slots: Vec<Option<Slot>>,
    hasher: PositionHasher,
}

/// Vertex id plus one, so that an empty slot takes no extra space.
type Slot = std::num::NonZeroU32;

impl Welder {
    /// Allocates memory for the given number of facets; a closed mesh has half as many vertices.
    pub fn with_facets(facets: usize) -> Self {
        Self {
            positions: Vec::with_capacity(facets / 2),
            slots: vec![None; facets.next_power_of_two().max(8)],
            hasher: PositionHasher::new(),
        }
    }

    /// Returns the vertex at a position, new unless one has the same coordinates bit for bit; −0
    /// equals 0.
    pub fn vertex(&mut self, position: [f64; 3]) -> VertexId {
        let position = position.map(|x| x + 0.0);
        let slot = self.find(position);
        if let Some(id) = self.slots[slot] {
            return VertexId(id.get() - 1);
        }
        let id = VertexId::new(self.positions.len());
        self.slots[slot] = Slot::new(id.0 + 1);
        self.positions.push(position);
        if 2 * self.positions.len() > self.slots.len() {
            self.grow();
        }
        id
    }

    /// Returns the slot of a position, or the empty one where it belongs.
    fn find(&self, position: [f64; 3]) -> usize {
        let mask = self.slots.len() - 1;
        let mut slot = self.hasher.hash(position) & mask;
        while let Some(id) = self.slots[slot]
            && self.positions[id.get() as usize - 1] != position
        {
            slot = (slot + 1) & mask;
        }
        slot
    }

    #[cold]
    fn grow(&mut self) {
        self.slots = vec![None; 2 * self.slots.len()];
        for id in 0..self.positions.len() {
            let slot = self.find(self.positions[id]);
            self.slots[slot] = Slot::new(id as u32 + 1);
        }
    }
}

/// Hash of two folded multiplications with secret factors, so that no file can be crafted whose
/// positions all collide. Ids follow the order of the file, so the secret never affects the result.
struct PositionHasher([u64; 3]);

impl PositionHasher {
    fn new() -> Self {
        let state = RandomState::new();
        Self([0, 1, 2].map(|i| state.hash_one(i)))
    }

    fn hash(&self, position: [f64; 3]) -> usize {
        let [a, b, c] = self.0;
        let [x, y, z] = position.map(f64::to_bits);
        fold(fold(x ^ a, y ^ b) ^ z, c | 1) as usize
    }
}

/// Folds the two halves of the long product.
fn fold(a: u64, b: u64) -> u64 {
    let product = u128::from(a) * u128::from(b);
    product as u64 ^ (product >> 64) as u64
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    #[test]
    fn ids_are_those_of_a_plain_map_however_often_the_table_grows() {
        let mut welder = Welder::with_facets(0);
        let mut plain = HashMap::new();
        for i in 0..20_000_u64 {
            // Every place twice or more, in a scattered order.
            let place = i * 7919 % 4096;
            let position = [place % 16, place / 16 % 16, place / 256].map(|x| x as f64 * 0.1);
            let next = plain.len() as u32;
            let expected = *plain.entry(place).or_insert(next);
            assert_eq!(welder.vertex(position), VertexId(expected));
        }
        assert_eq!(welder.positions.len(), 4096);
    }
}
