//! Packs the wedges of a forest in the order of a model.

use std::collections::BTreeMap;

use super::recorded_splits::{LOST, RecordedSplits};
use super::{ForestWedges, NodeWedges, WedgeLabels, WedgeNumbers, WedgeSplit, Wedges};
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
    pub(crate) values: WedgeNumbers,
    pub(crate) labels: WedgeLabels,
}

impl DetachedWedges {
    /// Packs the wedges in the order of a model. Records need no change: in every set of updates
    /// that is closed upwards, nodes keep their relative order.
    pub(crate) fn assemble(&self, order: &Order) -> Wedges {
        let of = |node: u32| self.first[node as usize]..self.first[node as usize + 1];
        let numbers = || order.nodes.iter().flat_map(|&node| of(node));
        let updates = (0..).zip(&order.updates);
        let records = updates.filter_map(|(at, u)| Some((at, self.records.get(u)?.clone())));
        Wedges {
            of_nodes: NodeWedges::new(order.nodes.iter().map(|&node| of(node).len() as u32)),
            base: self.base.clone(),
            splits: RecordedSplits::new(records),
            values: self.values.packed(numbers()),
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
    let corners = all.corners.iter().zip(&forest.created_by).filter(|(_, by)| **by == NONE);
    let root = |wedge: u32| number[roots[wedge as usize] as usize];
    corners.map(|(face, _)| face.map(root)).collect()
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
        let place = |n: u32| order.index_of_node[n as usize];
        let mut around: Vec<_> =
            split.around.iter().map(|&(ends, wedge)| (ends.map(place), wedge)).collect();
        around.sort_unstable();
        for (_, wedge) in around {
            let child = children.into_iter().find(|&child| all.of(child).contains(&wedge));
            record.push(self.number(child.unwrap_or(children[0]), wedge)?);
        }
        for nodes in self.created() {
            let corners = split.created.iter().find_map(|(face, wedges)| {
                let turn = (0..3).find(|&turn| rotated(*face, turn) == nodes)?;
                Some(rotated(*wedges, turn))
            });
            let corners = corners.unwrap_or_else(|| nodes.map(|node| all.first[node as usize]));
            for (node, wedge) in nodes.into_iter().zip(corners) {
                record.push(self.number(node, wedge)?);
            }
        }
        Ok(record)
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
