//! Copies of a model with one wrong field, for tests of the certificate.

use super::splits::{Local, Splits};
use super::{Implicit, LAST_WING, NO_WING, OPEN};

impl Implicit {
    /// Returns copies in which one field of an update is changed.
    pub(crate) fn corrupted(&self, update: u32) -> Vec<Self> {
        let corrupt = |change: &dyn Fn(&mut Local)| self.with(update, change);
        vec![
            corrupt(&|split| split.level = 0),
            corrupt(&|split| split.level = (split.level - 1).min(split.level)),
            corrupt(&|split| split.level += 1),
            corrupt(&|split| split.level = u16::MAX >> 1),
            corrupt(&|split| split.wings[1] = split.wings[0]),
            corrupt(&|split| split.wings.reverse()),
            corrupt(&|split| split.wings[0] = NO_WING),
            corrupt(&|split| split.wings[1] = 0),
            corrupt(&|split| split.wings[0] = split.wings[1]),
            corrupt(&|split| split.wings = [LAST_WING; 2]),
        ]
    }

    /// Returns copies in which both wings of an update are one vertex, by its rank or as the last.
    pub(crate) fn with_both_wings_at_one_vertex(&self, update: u32) -> Vec<Self> {
        let both = (0..12).chain([LAST_WING]);
        both.map(|wing| self.with(update, &|split| split.wings = [wing; 2])).collect()
    }

    /// Returns a copy in which an update is not marked as open.
    pub(crate) fn without_open_mark(&self, update: u32) -> Self {
        self.with(update, &|split| split.level &= !OPEN)
    }

    fn with(&self, update: u32, change: &dyn Fn(&mut Local)) -> Self {
        let mut changed = self.clone();
        let Splits::Full(splits) = &mut changed.splits else { unreachable!("never compacted") };
        change(&mut splits[update as usize].local);
        changed
    }

    /// Returns copies in which a non-fan split creates a wrong face: a child's corner is moved to a
    /// surrounding node, or to one that is mostly not active yet.
    pub(crate) fn corrupted_non_fan(&self) -> Vec<Self> {
        let mut all = Vec::new();
        for (&update, non_fan) in &self.non_fan_splits {
            let children = self.children(update);
            let Some(face) = non_fan.created_faces.first() else { continue };
            let Some(corner) = face.iter().position(|node| children.contains(node)) else {
                continue;
            };
            let others =
                non_fan.second.iter().flatten().copied().chain([self.node_count() as u32 - 1]);
            for other in others.filter(|node| !face.contains(node)) {
                let mut wrong = self.clone();
                wrong.non_fan_splits.get_mut(&update).expect("a copy").created_faces[0][corner] =
                    other;
                all.push(wrong);
            }
        }
        all
    }
}
