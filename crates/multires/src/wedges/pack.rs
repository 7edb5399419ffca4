//! Packs the wedges of a forest in the order of a model.

use std::collections::BTreeMap;
use std::ops::Range;

use super::recorded_splits::{LOST, RecordedSplits};
use super::{ForestWedges, NodeWedges, WedgeLabels, WedgeSplit, WedgeValues, Wedges};
use crate::forest::{BuildError, Forest, NONE};
use crate::implicit::Order;

impl Wedges {
    /// Packs the wedges of a forest.
    /// # Errors
    /// A vertex of more than 65,534 wedges.
    pub(crate) fn in_order(
        forest: &Forest,
        all: &ForestWedges,
        order: &Order,
    ) -> Result<Self, BuildError> {
        let numbers = || order.nodes.iter().flat_map(|&node| all.of(node));
        let mut records = Vec::new();
        for (at, &update) in (0..).zip(&order.updates) {
            if let Some(split) = all.splits.get(&update) {
                let local = RecordPacker { forest, all, order, update: update as usize };
                records.push((at, local.record(split)?));
            }
        }
        Ok(Self {
            of_nodes: NodeWedges::new(order.nodes.iter().map(|&node| all.count(node))),
            base: base(forest, all, order),
            splits: RecordedSplits::new(records.into_iter()),
            values: all.values.packed(numbers()),
            labels: all.labels.packed(numbers()),
        })
    }

    /// Returns the wedges of a forest in its own order, without records of splits.
    pub(crate) fn of_forest(all: &ForestWedges) -> Self {
        let counts = all.first.windows(2).map(|ends| ends[1] - ends[0]);
        Self {
            of_nodes: NodeWedges::new(counts),
            values: all.values.packed(0..all.len() as u32),
            labels: all.labels.packed(0..all.len() as u32),
            ..Self::default()
        }
    }
}

/// Wedges taken out of their model, in any order of nodes with roots first.
#[derive(Clone, Debug)]
pub(crate) struct DetachedWedges {
    /// First wedge of each node, and the end of the last.
    pub(crate) first: Vec<u32>,
    /// Records of updates next to seams.
    pub(crate) records: BTreeMap<u32, Vec<u16>>,
    /// Wedges at the corners of the base mesh's faces.
    pub(crate) base: Vec<[u32; 3]>,
    pub(crate) labels: WedgeLabels,
}

impl DetachedWedges {
    /// Returns the wedges of a node.
    pub(crate) fn of(&self, node: u32) -> Range<u32> {
        self.first[node as usize]..self.first[node as usize + 1]
    }

    /// Packs the wedges in the order of a model, still without values. Records need no change: in
    /// every set of updates that is closed upwards, nodes keep their relative order.
    pub(crate) fn assemble(&self, order: &Order) -> Wedges {
        let numbers = || order.nodes.iter().flat_map(|&node| self.of(node));
        let updates = (0..).zip(&order.updates);
        let records = updates.filter_map(|(at, u)| Some((at, self.records.get(u)?.clone())));
        Wedges {
            of_nodes: NodeWedges::new(order.nodes.iter().map(|&node| self.of(node).len() as u32)),
            base: self.base.clone(),
            splits: RecordedSplits::new(records),
            values: WedgeValues::default(),
            labels: self.labels.packed(numbers()),
        }
    }
}

/// Returns the wedges at the corners of the base mesh's faces.
fn base(forest: &Forest, all: &ForestWedges, order: &Order) -> Vec<[u32; 3]> {
    // Parents have higher numbers.
    let mut roots: Vec<u32> = (0..all.len() as u32).collect();
    for wedge in (0..all.len()).rev().filter(|&wedge| all.parents[wedge] != NONE) {
        roots[wedge] = roots[all.parents[wedge] as usize];
    }
    let mut number = vec![NONE; all.len()];
    let packed = order.nodes.iter().flat_map(|&node| all.of(node));
    (0..).zip(packed).for_each(|(at, wedge)| number[wedge as usize] = at);
    let root = |wedge: u32| number[roots[wedge as usize] as usize];
    let faces = order.base_faces(forest);
    faces.iter().map(|face| face.corners(&all.corners).map(root)).collect()
}

/// An update whose record is converted to local numbers.
struct RecordPacker<'f> {
    forest: &'f Forest,
    all: &'f ForestWedges,
    order: &'f Order,
    update: usize,
}

impl RecordPacker<'_> {
    fn record(&self, split: &WedgeSplit) -> Result<Vec<u16>, BuildError> {
        let Self { forest, all, order, update } = *self;
        let children = forest.updates[update].children;
        let node = forest.node(update) as u32;
        let mut record = Vec::new();
        for wedge in children.into_iter().flat_map(|child| all.of(child)) {
            record.push(match all.parents[wedge as usize] {
                NONE => LOST,
                parent => self.number(node, parent)?,
            });
        }
        if let Some(sides) = self.sides(split) {
            record.extend(sides);
            return Ok(record);
        }
        let place = |n: u32| order.index_of_node[n as usize];
        let mut around: Vec<_> =
            split.around.iter().map(|&(ends, [own, ..])| (ends.map(place), own)).collect();
        around.sort_unstable();
        for (_, wedge) in around {
            record.push(self.number(self.child_with(wedge), wedge)?);
        }
        for nodes in self.created() {
            for (node, wedge) in nodes.into_iter().zip(self.corners(split, nodes)) {
                record.push(self.number(node, wedge)?);
            }
        }
        Ok(record)
    }

    /// Returns for each face that the split creates which of the faces next to it it continues, if
    /// all wedges follow from that and from the parents.
    fn sides(&self, split: &WedgeSplit) -> Option<Vec<u16>> {
        let all = self.all;
        if self.forest.non_fan_splits.contains_key(&(self.update as u32)) {
            return None;
        }
        let below = |child: u32, parent: u32| {
            all.of(child).find(|&wedge| all.parents[wedge as usize] == parent)
        };
        let parent = |wedge: u32| Some(all.parents[wedge as usize]).filter(|&up| up != NONE);
        let follows = |own: u32| below(self.child_with(own), parent(own)?).filter(|&is| is == own);
        split.around.iter().try_for_each(|(_, [own, ..])| follows(*own).map(|_| ()))?;
        let side = |[first, wing, second]: [u32; 3]| {
            let continues = |side: &usize| {
                let mut next = split.around.iter().filter(|(ends, _)| ends[*side] == wing);
                let (Some((_, wedges)), None) = (next.next(), next.next()) else { return false };
                let Some(parent) = parent(wedges[0]) else { return false };
                let corners = [below(first, parent), Some(wedges[1 + side]), below(second, parent)];
                corners == self.corners(split, [first, wing, second]).map(Some)
            };
            (0..2).find(continues).map(|side| side as u16)
        };
        self.created().into_iter().map(side).collect()
    }

    /// Returns the child that a wedge belongs to.
    fn child_with(&self, wedge: u32) -> u32 {
        let children = self.forest.updates[self.update].children;
        let child = children.into_iter().find(|&child| self.all.of(child).contains(&wedge));
        child.unwrap_or(children[0])
    }

    /// Returns the wedges at the corners of a face that the split creates.
    fn corners(&self, split: &WedgeSplit, nodes: [u32; 3]) -> [u32; 3] {
        let corners = split.created.iter().find_map(|(face, wedges)| {
            let turn = (0..3).find(|&turn| rotated(*face, turn) == nodes)?;
            Some(rotated(*wedges, turn))
        });
        corners.unwrap_or_else(|| nodes.map(|node| self.all.first[node as usize]))
    }

    /// Returns the faces that the split creates, in the order in which a model creates them.
    fn created(&self) -> Vec<[u32; 3]> {
        let Self { forest, update, .. } = *self;
        let [first, second] = forest.updates[update].children;
        if let Some(non_fan) = forest.non_fan_splits.get(&(update as u32)) {
            return non_fan.created_faces.clone();
        }
        let [start, end] = forest.updates[update].wings;
        let faces = [[first, start, second], [second, end, first]];
        faces.into_iter().filter(|face| face[1] != NONE).collect()
    }

    fn number(&self, node: u32, wedge: u32) -> Result<u16, BuildError> {
        let local = wedge - self.all.first[node as usize];
        u16::try_from(local).ok().filter(|&local| local < LOST).ok_or(BuildError::TooManyWedges)
    }
}

fn rotated([a, b, c]: [u32; 3], turn: usize) -> [u32; 3] {
    [[a, b, c], [b, c, a], [c, a, b]][turn]
}
