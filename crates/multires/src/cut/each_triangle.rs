//! Enumeration of every triangle that occurs in some cut.

use super::front::Front;
use crate::forest::MAX_LEVELS;
use crate::forest::by_level;
use crate::implicit::Implicit;

impl Implicit {
    /// Calls `visit` with the nodes of each triangle that occurs in some cut: those of the base
    /// mesh and those that updates create. Stops early if an uncertified model cannot be refined
    /// further.
    ///
    /// Cost: linear.
    pub(crate) fn each_triangle(&self, mut visit: impl FnMut([u32; 3])) {
        let mut front = Front::new(self);
        front.triangles.reserve(2 * self.update_count());
        self.base().iter().for_each(|&face| visit(face));
        // Fused updates stay together.
        let order = by_level(self.update_count(), |update| {
            MAX_LEVELS
                - self.level(if self.is_fused_with_parent(update) { update - 1 } else { update })
        });
        let mut waiting = Vec::new();
        for update in order {
            let before = front.triangles.slots() as u32;
            if !front.is_active(self.parent(update)) || !front.split(update, &mut waiting) {
                return;
            }
            let around = front.last_star().iter().map(|spoke| spoke.corner / 3);
            let created = before..front.triangles.slots() as u32;
            around.chain(created).for_each(|t| visit(front.triangles.nodes(t)));
        }
    }
}
