//! Members of a frame, sorted by level.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use meshlod::flock::Members;
use meshlod::flock::select::InstanceLevel;

/// Member in a buffer of instances: 24 bytes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub(super) struct Instance {
    /// Position relative to the origin of the frame, in body lengths.
    pub position: [f32; 3],
    /// Unit vector in which the member swims.
    pub heading: [f32; 3],
}

/// Members in the order of their slots: one for each level, and a last one for impostors.
#[derive(Debug, Default)]
pub(super) struct SortedInstances {
    pub instances: Vec<Instance>,
    /// First instance of each slot, and their number.
    starts: Vec<u32>,
    next: Vec<u32>,
}

impl SortedInstances {
    /// Sorts the members of a frame by level, in the order of the members within a level.
    ///
    /// Members without a level in the table, and those whose position is not finite, are left out.
    /// Allocates only where there are more members than ever before.
    pub fn sort(&mut self, members: &Members, levels: &[InstanceLevel], slots: &LevelSlots) {
        let level_of = |(member, &level): (usize, &InstanceLevel)| {
            let slot = slots.of(level)?;
            members.position(member).is_finite().then_some((member, slot))
        };
        let drawn = || levels.iter().enumerate().take(members.len()).filter_map(level_of);
        self.next.clear();
        self.next.resize(slots.count() + 1, 0);
        for (_, slot) in drawn() {
            self.next[slot + 1] += 1;
        }
        for slot in 0..slots.count() {
            self.next[slot + 1] += self.next[slot];
        }
        self.starts.clone_from(&self.next);
        let count = self.next[slots.count()] as usize;
        self.instances.resize(count, Instance::default());
        for (member, slot) in drawn() {
            let position = (members.position(member) - slots.origin).to_array();
            let heading = members.heading(member).to_array();
            self.instances[self.next[slot] as usize] = Instance { position, heading };
            self.next[slot] += 1;
        }
    }

    /// Returns the instances of a slot.
    pub fn of(&self, slot: usize) -> Range<u32> {
        let bound = |slot: usize| self.starts.get(slot).copied().unwrap_or(0);
        bound(slot)..bound(slot + 1)
    }
}

/// Places for the members of each level.
#[derive(Clone, Copy, Debug)]
pub(super) struct LevelSlots {
    /// Levels of the table.
    pub levels: usize,
    /// Slot of impostors: the one after all levels, or that of a level.
    pub impostors: usize,
    /// Point that positions become relative to.
    pub origin: Vec3,
}

impl LevelSlots {
    fn count(&self) -> usize {
        self.levels + 1
    }

    fn of(&self, level: InstanceLevel) -> Option<usize> {
        if level.is_impostor() {
            return Some(self.impostors);
        }
        level.level().filter(|&level| level < self.levels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_are_sorted_by_level_and_keep_their_order() {
        let mut members = Members::default();
        for x in [0.0, 1.0, 2.0, 3.0, f32::NAN, 5.0] {
            members.push([x, 0.0, 0.0], [0.0, 0.0, 1.0]);
        }
        let level = InstanceLevel::drawn;
        let levels = [level(1), InstanceLevel::IMPOSTOR, level(0), level(1), level(0), level(7)];
        let slots = LevelSlots { levels: 3, impostors: 3, origin: Vec3::X };
        let mut sorted = SortedInstances::default();
        for _ in 0..2 {
            sorted.sort(&members, &levels, &slots);
            let x: Vec<f32> = sorted.instances.iter().map(|i| i.position[0]).collect();
            assert_eq!(x, [1.0, -1.0, 2.0, 0.0]);
            assert_eq!([0, 1, 2, 3].map(|slot| sorted.of(slot)), [0..1, 1..3, 3..3, 3..4]);
        }
        assert_eq!(SortedInstances::default().of(2), 0..0);
    }
}
