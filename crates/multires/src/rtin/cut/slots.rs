//! Triangles by slot, with a record of the slots that changed.

use crate::forest::NONE;
use crate::slot_mesh::Patch;

/// An empty slot.
const HOLE: [u32; 3] = [NONE; 3];

/// Triangles by slot. A triangle keeps its slot until it is replaced, and a slot that becomes empty
/// is the next to be used.
#[derive(Clone, Debug, Default)]
pub(super) struct TriangleSlots {
    nodes: Vec<[u32; 3]>,
    /// Mark at which each slot was last changed.
    changed_at: Vec<u32>,
    holes: Vec<u32>,
    mark: u32,
    /// Slots changed since the mark, with their nodes at that time.
    changed: Vec<(u32, [u32; 3])>,
}

impl TriangleSlots {
    /// Starts a new record of changes.
    pub(super) fn mark(&mut self) {
        self.mark = self.mark.wrapping_add(1);
        self.changed.clear();
    }

    /// Returns the number of triangles.
    pub(super) fn len(&self) -> usize {
        self.nodes.len() - self.holes.len()
    }

    /// Returns the number of slots, including empty ones.
    pub(super) fn slots(&self) -> usize {
        self.nodes.len()
    }

    /// Returns the nodes of a triangle; `None` for an empty slot or one that does not exist.
    pub(super) fn get(&self, slot: u32) -> Option<[u32; 3]> {
        self.nodes.get(slot as usize).and_then(|&nodes| real(nodes))
    }

    /// Iterates over the triangles by slot and nodes.
    pub(super) fn iter(&self) -> impl Iterator<Item = (u32, [u32; 3])> + '_ {
        (0..).zip(&self.nodes).filter_map(|(slot, &nodes)| Some((slot, real(nodes)?)))
    }

    /// Iterates over the slots changed since the mark.
    pub(super) fn changes(&self) -> impl Iterator<Item = Patch> + '_ {
        let patch = |&(slot, old): &(u32, [u32; 3])| {
            let new = self.nodes[slot as usize];
            (old != new).then(|| Patch { slot, old: real(old), new: real(new) })
        };
        self.changed.iter().filter_map(patch)
    }

    /// Puts a triangle into an empty slot, and returns the slot.
    pub(super) fn add(&mut self, nodes: [u32; 3]) -> u32 {
        let slot = self.holes.pop().unwrap_or_else(|| {
            self.nodes.push(HOLE);
            self.changed_at.push(self.mark.wrapping_sub(1));
            self.nodes.len() as u32 - 1
        });
        self.replace(slot, nodes);
        slot
    }

    /// Replaces the triangle in a slot.
    pub(super) fn replace(&mut self, slot: u32, nodes: [u32; 3]) {
        let changed_at = &mut self.changed_at[slot as usize];
        let was = std::mem::replace(&mut self.nodes[slot as usize], nodes);
        if std::mem::replace(changed_at, self.mark) != self.mark {
            self.changed.push((slot, was));
        }
    }

    /// Empties a slot.
    pub(super) fn remove(&mut self, slot: u32) {
        self.replace(slot, HOLE);
        self.holes.push(slot);
    }
}

fn real(nodes: [u32; 3]) -> Option<[u32; 3]> {
    (nodes != HOLE).then_some(nodes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_from_the_mark_to_now() {
        let mut slots = TriangleSlots::default();
        let first = slots.add([0, 1, 2]);
        slots.mark();
        let second = slots.add([3, 4, 5]);
        slots.replace(first, [6, 7, 8]);
        slots.replace(first, [0, 1, 2]);
        let patch = |slot, old, new| Patch { slot, old, new };
        assert_eq!(slots.changes().collect::<Vec<_>>(), [patch(second, None, Some([3, 4, 5]))]);
        slots.mark();
        slots.remove(first);
        assert_eq!(slots.changes().collect::<Vec<_>>(), [patch(first, Some([0, 1, 2]), None)]);
        assert_eq!((slots.len(), slots.slots(), slots.get(first)), (1, 2, None));
        assert_eq!(slots.add([9, 1, 2]), first, "an empty slot is used again");
        assert_eq!(slots.iter().collect::<Vec<_>>(), [(first, [9, 1, 2]), (second, [3, 4, 5])]);
    }
}
