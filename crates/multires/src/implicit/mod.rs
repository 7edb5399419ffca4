//! The implicit MT: the contractions alone, packed. No triangle is stored but those of the base.
//!
//! A split is told by two wings, each by its rank among the vertices around: where the run of faces
//! starts that go to the second child, and where it ends. What a split needs first is told by levels
//! (see the notes): a vertex may be split when all around it are of lower levels, and then exactly the
//! recorded ones are around it. That is also what makes ranks enough for wings.
//!
//! | bytes an update | |
//! |--:|---|
//! | 24 | positions of its two children |
//! | 8 | the node it splits, and where the updates of the second child start |
//! | 4 | radius and error |
//! | 4 | level and wings |
//!
//! [Narrow](Implicit::narrowed), the same takes 12 bytes for places and 10 for the rest.

mod assemble;
mod budget;
mod compact;
mod dependencies;
mod extractor;
mod faces;
mod from_forest;
mod order;
mod positions;
mod saturated;
mod splits;

use std::collections::BTreeMap;

use glam::{DVec3, Vec3};

use crate::bounds::ErrorKind;
use crate::forest::{MAX_LEVELS, NonFanSplit};
use crate::frame::{Frame, Length16};
use crate::level::Level;
use crate::pack::ExactPositions;
use crate::query::{Ball, PackedBall};

pub(crate) use assemble::{BaseMesh, DetachedUpdate, ModelInfo, has_three_corners};
pub(crate) use budget::Weight;
pub(crate) use dependencies::Dependencies;
pub use dependencies::SplitRule;
pub use extractor::Extractor;
pub(crate) use faces::Faces;
pub(crate) use order::Order;
pub(crate) use saturated::SaturatedBalls;

use self::positions::StoredPositions;
use self::splits::{Local, Splits};

/// All levels of a mesh, in 40 bytes a vertex or in 22.
///
/// Nodes are the vertices of all levels: first the roots, then the children of update 0, of update 1…
#[derive(Clone, Debug)]
pub struct Implicit {
    frame: Frame,
    error_kind: ErrorKind,
    roots: u32,
    /// Where the updates below each root start, and the last of them end.
    trees: Vec<u32>,
    positions: StoredPositions,
    /// Of the input's vertices, where they are kept as they were.
    exact: ExactPositions,
    splits: Splits,
    /// The coarsest faces, by roots.
    base: Vec<[u32; 3]>,
    /// What wings cannot tell, by update, in nodes of this model.
    non_fan_splits: BTreeMap<u32, NonFanSplit>,
    full_faces: usize,
}

/// A vertex around another, as an update stores it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wing {
    /// There is none: the run of faces starts or ends on the boundary.
    None,
    /// Its rank among the nodes around that a face follows, counter-clockwise.
    Rank(u8),
    /// The one node around that no face follows.
    Last,
}

const FLAG: u32 = 1 << 31;
const OPEN: u16 = MAX_LEVELS;
const NO_WING: u8 = u8::MAX;
const LAST_WING: u8 = u8::MAX - 1;

impl Implicit {
    /// How many updates there are.
    pub fn update_count(&self) -> usize {
        self.splits.len()
    }

    /// How many vertices the coarsest mesh has.
    pub fn root_count(&self) -> usize {
        self.roots as usize
    }

    /// How many faces the coarsest mesh has.
    pub fn base_faces(&self) -> usize {
        self.base.len()
    }

    /// How many faces the finest mesh has.
    pub fn full_faces(&self) -> usize {
        self.full_faces
    }

    /// What the errors of its updates are.
    pub fn error_kind(&self) -> ErrorKind {
        self.error_kind
    }

    /// Where a node is, in model units; [`Patch`](crate::Patch) and [`Level`](crate::Level) tell of
    /// vertices by their nodes.
    ///
    /// # Panics
    /// Nodes are numbered below [`node_count`](Self::node_count).
    pub fn position(&self, node: u32) -> [f64; 3] {
        self.exact.get(node).unwrap_or_else(|| self.frame.model(self.stored_position(node)))
    }

    /// The nodes that a node is split into, which have higher numbers; `None` for those of the finest level.
    ///
    /// # Panics
    /// As [`position`](Self::position).
    pub fn children_of(&self, node: u32) -> Option<[u32; 2]> {
        self.update_of(node).map(|update| self.children(update))
    }

    /// How many nodes there are, the vertices of all levels.
    pub fn node_count(&self) -> usize {
        self.positions.len()
    }

    /// The same model in 22 bytes a vertex: the places of two children in 12, all else of an update in 10.
    ///
    /// It answers everything alike, and extraction goes through half the memory. `None` where something
    /// would not be the same: radii, errors or places that are more exact than those of a file, as of a
    /// [`Forest`](crate::Forest); places further out than 32,767 cells, which no file has that moves
    /// vertices by .0017 % of the diagonal or more, unless a contraction left its box; 4,096 levels of one
    /// error.
    pub fn compacted(&self) -> Option<Self> {
        let (positions, splits) = (self.positions.compacted()?, self.splits.compacted(self.roots)?);
        let (trees, base, non_fan_splits) =
            (self.trees.clone(), self.base.clone(), self.non_fan_splits.clone());
        let exact = self.exact.clone();
        Some(Self { positions, splits, trees, base, non_fan_splits, exact, ..*self })
    }

    /// What it takes in memory.
    pub fn bytes(&self) -> usize {
        let non_fan = |o: &NonFanSplit| {
            size_of::<NonFanSplit>()
                + size_of_val(&o.second[..])
                + size_of_val(&o.created_faces[..])
        };
        size_of_val(&self.trees[..])
            + self.positions.bytes()
            + self.exact.bytes()
            + self.splits.bytes()
            + size_of_val(&self.base[..])
            + self.non_fan_splits.values().map(non_fan).sum::<usize>()
    }

    pub(crate) fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Where a node is, in stored units.
    #[inline]
    pub(crate) fn stored_position(&self, node: u32) -> [f32; 3] {
        self.positions.at(node)
    }

    /// The same of a node that is kept to the bit where that is, not rounded to what is stored.
    pub(crate) fn exact_stored(&self, node: u32) -> DVec3 {
        let rounded = || Vec3::from(self.stored_position(node)).as_dvec3();
        self.exact.get(node).map_or_else(rounded, |exact| self.frame.point(exact.into()))
    }

    /// The mesh of some faces.
    pub(crate) fn level_from_faces(&self, faces: Vec<[u32; 3]>) -> Level {
        Level::from_nodes(self.frame, self.node_count(), |node| self.stored_position(node), faces)
            .with_exact(&self.exact)
    }

    /// The positions that nothing has rounded, by node.
    pub(crate) fn exact(&self) -> &ExactPositions {
        &self.exact
    }

    pub(crate) fn base(&self) -> &[[u32; 3]] {
        &self.base
    }

    /// The nodes that an update splits its node into.
    #[inline]
    pub(crate) fn children(&self, update: u32) -> [u32; 2] {
        let first = self.roots + 2 * update;
        [first, first + 1]
    }

    /// The update that a node is a child of; `None` for roots.
    #[inline]
    pub(crate) fn creator(&self, node: u32) -> Option<u32> {
        node.checked_sub(self.roots).map(|child| child / 2)
    }

    /// The update that splits a node; `None` for leaves.
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

    /// The node that an update splits.
    #[inline]
    pub(crate) fn parent(&self, update: u32) -> u32 {
        self.splits.parent(update) & !FLAG
    }

    /// Whether the first child is split in the same go, by the next update.
    #[inline]
    pub(crate) fn is_fused_with_child(&self, update: u32) -> bool {
        self.splits.parent(update) & FLAG != 0
    }

    /// Whether an update goes in the same go as the one before it, which splits its node's parent.
    #[inline]
    pub(crate) fn is_fused_with_parent(&self, update: u32) -> bool {
        update.checked_sub(1).is_some_and(|before| self.is_fused_with_child(before))
    }

    /// Above those of all that it needs first.
    #[inline]
    pub(crate) fn level(&self, update: u32) -> u16 {
        self.splits.local(update).level & !OPEN
    }

    /// Whether around an update's vertex may be one whom no face follows.
    #[inline]
    pub(crate) fn is_open(&self, update: u32) -> bool {
        self.splits.local(update).level & OPEN != 0
    }

    /// The error of an update's coarse side.
    #[inline]
    pub(crate) fn error(&self, update: u32) -> Length16 {
        self.splits.local(update).error
    }

    /// The least error of the updates that were made to come to these nodes; infinite for none.
    pub(crate) fn least_error_above(&self, nodes: &[u32]) -> Length16 {
        let made = nodes.iter().filter_map(|&node| self.creator(node));
        made.map(|update| self.error(update)).min().unwrap_or(Length16::INFINITE)
    }

    /// What an update's need is judged by.
    #[inline]
    pub(crate) fn ball(&self, update: u32) -> Ball {
        self.ball_at(update, self.parent(update))
    }

    /// The same where the node is known.
    #[inline]
    pub(crate) fn ball_at(&self, update: u32, node: u32) -> Ball {
        self.packed_ball(update, node).unpack()
    }

    /// The same as it is stored.
    #[inline]
    pub(crate) fn packed_ball(&self, update: u32, node: u32) -> PackedBall {
        let Local { radius, error, .. } = self.splits.local(update);
        PackedBall { center: self.stored_position(node), radius, error }
    }

    /// The wings of an update.
    #[inline]
    pub(crate) fn wings(&self, update: u32) -> [Wing; 2] {
        self.splits.local(update).wings.map(|wing| match wing {
            NO_WING => Wing::None,
            LAST_WING => Wing::Last,
            rank => Wing::Rank(rank),
        })
    }

    /// What the wings of an update cannot tell.
    pub(crate) fn non_fan_split(&self, update: u32) -> Option<&NonFanSplit> {
        self.non_fan_splits.get(&update)
    }

    /// Each root, and the run of updates below it.
    pub(crate) fn roots(&self) -> impl Iterator<Item = (u32, [u32; 2])> + '_ {
        (0..self.roots)
            .map(|root| (root, [self.trees[root as usize], self.trees[root as usize + 1]]))
    }

    /// The children of a node that is split, the second one first.
    #[inline]
    fn below(&self, Subtree { start, end, leaf, .. }: Subtree) -> [Subtree; 2] {
        let [first, second] = self.children(start);
        let middle = self.splits.second(start) & !FLAG;
        // There is a leaf more than updates below the first child.
        let next = leaf + middle - start;
        [
            Subtree { node: second, start: middle, end, leaf: next },
            Subtree { node: first, start: start + 1, end: middle, leaf },
        ]
    }
}

#[cfg(test)]
impl Implicit {
    /// Copies with something of an update changed.
    pub(crate) fn corrupted(&self, update: u32) -> Vec<Self> {
        let corrupt = |change: &dyn Fn(&mut Local)| {
            let mut wrong = self.clone();
            let Splits::Full(splits) = &mut wrong.splits else { unreachable!("none is narrow") };
            change(&mut splits[update as usize].local);
            wrong
        };
        vec![
            corrupt(&|split| split.level = 0),
            corrupt(&|split| split.level = (split.level - 1).min(split.level)),
            corrupt(&|split| split.level += 1),
            corrupt(&|split| split.level = u16::MAX >> 1),
            corrupt(&|split| split.wings[1] = split.wings[0]),
            corrupt(&|split| split.wings.reverse()),
            corrupt(&|split| split.wings[0] = NO_WING),
            corrupt(&|split| split.wings[1] = 0),
        ]
    }

    /// Copies in which an odd update brings a face to another place: with a child's corner at a node
    /// that is around, or at one that is mostly not there yet.
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

/// A node to go down from.
#[derive(Clone, Copy, Debug, Default)]
struct Subtree {
    node: u32,
    /// The run of updates below it, of which the first splits it.
    start: u32,
    end: u32,
    /// Its first leaf.
    leaf: u32,
}
