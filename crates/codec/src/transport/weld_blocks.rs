//! Welding of the vertices that different blocks share.
//!
//! Each block stores the vertices on its border. Border vertices in one cell are one vertex unless
//! their tags differ; a tag is 0 unless stated otherwise. Few different vertices share a cell, so
//! tags take hardly any space.

use super::predict::CellVec;

/// Hash table from cell and tag to a vertex.
pub(super) struct WeldTable {
    slots: Vec<Slot>,
    len: usize,
}

#[derive(Clone, Copy)]
struct Slot {
    key: u64,
    tag: u32,
    vertex: u32,
}

const EMPTY: u32 = u32::MAX;

/// Packs a cell into a number.
#[inline]
pub(super) fn key(cell: CellVec) -> u64 {
    // From here on, the lowest bits of floats are integers: no conversion has to care for others.
    const WHOLE: f32 = (1 << 23) as f32;
    let [x, y, z] = (cell + CellVec::splat(WHOLE)).to_array().map(f32::to_bits);
    let whole = WHOLE.to_bits();
    u64::from(x - whole) | u64::from(y - whole) << 21 | u64::from(z - whole) << 42
}

/// Computes a checksum over the cells of a block, in order.
pub(super) fn checksum(cells: impl Iterator<Item = CellVec>) -> u16 {
    let mix = |sum: u64, cell| (sum.rotate_left(23) ^ key(cell)).wrapping_mul(MIX);
    (cells.fold(0, mix) >> 48) as u16
}

/// 2⁶⁴ / golden ratio.
const MIX: u64 = 0x9e37_79b9_7f4a_7c15;

impl WeldTable {
    pub(super) fn new(capacity: usize) -> Self {
        let len = (2 * capacity).next_power_of_two().max(64);
        Self { slots: vec![Slot { key: 0, tag: 0, vertex: EMPTY }; len], len: 0 }
    }

    /// Returns the entry of a cell and tag, inserting `vertex` if it is new. `vertex` must not
    /// be `u32::MAX`.
    #[inline]
    pub(super) fn find_or_insert(&mut self, key: u64, tag: u32, vertex: u32) -> &mut u32 {
        if 2 * self.len >= self.slots.len() {
            self.grow();
        }
        let at = self.find(key, tag);
        let slot = &mut self.slots[at];
        if slot.vertex == EMPTY {
            *slot = Slot { key, tag, vertex };
            self.len += 1;
        }
        &mut slot.vertex
    }

    #[inline]
    fn find(&self, key: u64, tag: u32) -> usize {
        let mask = self.slots.len() - 1;
        let mixed = (key ^ u64::from(tag) << 32).wrapping_mul(MIX);
        let mut at = (mixed >> 32 ^ mixed >> 15) as usize & mask;
        loop {
            let slot = &self.slots[at];
            if slot.vertex == EMPTY || (slot.key == key && slot.tag == tag) {
                return at;
            }
            at = (at + 1) & mask;
        }
    }

    #[cold]
    fn grow(&mut self) {
        let mut wider = Self::new(self.slots.len());
        for slot in self.slots.iter().filter(|slot| slot.vertex != EMPTY) {
            let at = wider.find(slot.key, slot.tag);
            wider.slots[at] = *slot;
        }
        wider.len = self.len;
        *self = wider;
    }
}
