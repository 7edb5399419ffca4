//! Updates by their numbers: what each splits its node into, and what queries and cuts ask of it.

use super::splits::Local;
use super::{FLAG, Implicit, LAST_WING, NO_WING, OPEN, Wing};
use crate::forest::{NonFanSplit, Stage};
use crate::length16::Length16;
use crate::query::{Ball, PackedBall};

impl Implicit {
    /// Returns the nodes that an update splits its node into.
    #[inline]
    pub(crate) fn children(&self, update: u32) -> [u32; 2] {
        let first = self.roots + 2 * update;
        [first, first + 1]
    }

    /// Returns the update that creates a node, or `None` for a root.
    #[inline]
    pub(crate) fn creator(&self, node: u32) -> Option<u32> {
        node.checked_sub(self.roots).map(|child| child / 2)
    }

    /// Returns the update that splits a node, or `None` for a leaf.
    #[inline]
    pub(crate) fn update_of(&self, node: u32) -> Option<u32> {
        let Some(child) = node.checked_sub(self.roots) else {
            let start = self.trees[node as usize];
            return (start < self.trees[node as usize + 1]).then_some(start);
        };
        let family = child / 2;
        let second = self.splits.second(family);
        let (at, is_there) = match child % 2 {
            0 => (family + 1, family + 1 < second & !FLAG),
            _ => (second & !FLAG, second & FLAG != 0),
        };
        is_there.then_some(at)
    }

    /// Returns the node that an update splits.
    #[inline]
    pub(crate) fn parent(&self, update: u32) -> u32 {
        self.splits.parent(update) & !FLAG
    }

    /// Returns true if the update forms one face split with the next one, which splits its first
    /// child.
    #[inline]
    pub(crate) fn is_fused_with_child(&self, update: u32) -> bool {
        self.splits.parent(update) & FLAG != 0
    }

    /// Returns true if the update forms one face split with the one before it, whose first child it
    /// splits.
    #[inline]
    pub(crate) fn is_fused_with_parent(&self, update: u32) -> bool {
        update.checked_sub(1).is_some_and(|before| self.is_fused_with_child(before))
    }

    /// Returns the level of an update, which is below those of all its dependencies.
    #[inline]
    pub(crate) fn level(&self, update: u32) -> u16 {
        self.splits.local(update).level & !OPEN
    }

    /// Returns true if the vertex may have a neighbour that no face follows.
    #[inline]
    pub(crate) fn is_open(&self, update: u32) -> bool {
        self.splits.local(update).level & OPEN != 0
    }

    /// Returns the error of an update's coarse side.
    #[inline]
    pub(crate) fn error(&self, update: u32) -> Length16 {
        self.splits.local(update).error
    }

    /// Returns the least error of the updates that create the given nodes, or infinity if they are
    /// all roots.
    pub(crate) fn least_error_above(&self, nodes: &[u32]) -> Length16 {
        let made = nodes.iter().filter_map(|&node| self.creator(node));
        made.map(|update| self.error(update)).min().unwrap_or(Length16::INFINITE)
    }

    /// Returns the greatest error of the updates that split the given nodes; 0 if all are leaves.
    pub(crate) fn greatest_error_below(&self, nodes: &[u32]) -> f64 {
        let split = nodes.iter().filter_map(|&node| self.update_of(node));
        split.map(|update| self.error(update).get()).fold(0.0, f64::max)
    }

    /// Returns the stage of an update; `None` if stages are unknown.
    pub(crate) fn stage(&self, update: u32) -> Option<Stage> {
        self.stages.at(update as usize).and_then(|number| Stage::new(number as u32))
    }

    /// Returns the ball and error by which queries judge an update.
    #[inline]
    pub(crate) fn ball(&self, update: u32) -> Ball {
        self.ball_at(update, self.parent(update))
    }

    /// Returns the ball of an update whose node is known.
    #[inline]
    pub(crate) fn ball_at(&self, update: u32, node: u32) -> Ball {
        self.packed_ball(update, node).unpack()
    }

    /// Returns the ball of an update as it is stored.
    #[inline]
    pub(crate) fn packed_ball(&self, update: u32, node: u32) -> PackedBall {
        let Local { radius, error, .. } = self.splits.local(update);
        PackedBall { center: self.stored_position(node), radius, error }
    }

    /// Returns the wings of an update.
    #[inline]
    pub(crate) fn wings(&self, update: u32) -> [Wing; 2] {
        self.splits.local(update).wings.map(|wing| match wing {
            NO_WING => Wing::None,
            LAST_WING => Wing::Last,
            rank => Wing::Rank(rank),
        })
    }

    /// Returns the explicit faces of a split that wings cannot describe.
    pub(crate) fn non_fan_split(&self, update: u32) -> Option<&NonFanSplit> {
        self.non_fan_splits.get(&update)
    }

    /// Returns the number of faces that an update creates.
    pub(crate) fn created_count(&self, update: u32) -> usize {
        let wings = || self.wings(update).iter().filter(|&&wing| wing != Wing::None).count();
        self.non_fan_split(update).map_or_else(wings, |non_fan| non_fan.created_faces.len())
    }
}
