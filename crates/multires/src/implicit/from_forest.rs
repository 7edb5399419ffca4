//! Packs a contraction forest into the implicit model.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::positions::StoredPositions;
use super::splits::{Local, Split, Splits};
use super::{FLAG, Implicit, LAST_WING, NO_WING, OPEN, Order};
use crate::forest::{BuildError, Forest, NONE, NonFanSplit};
use crate::pack::PackedTable;
use crate::wedges::Wedges;

impl Implicit {
    /// Builds the packed model of all levels from a recorded simplification.
    ///
    /// Cost: linear.
    /// # Errors
    /// More than 2³¹ nodes, which is half as many vertices, or a vertex of more than 65,534 wedges.
    pub fn new(forest: &Forest) -> Result<Self, BuildError> {
        Self::in_order(forest, &Order::new(forest))
    }

    /// Builds a model in an order that its tables share.
    pub(crate) fn in_order(forest: &Forest, order: &Order) -> Result<Self, BuildError> {
        if order.nodes.len() >= FLAG as usize {
            return Err(BuildError::TooLarge);
        }
        let (mut splits, mut non_fans) = (Vec::with_capacity(order.updates.len()), BTreeMap::new());
        for at in 0..order.updates.len() {
            let update = order.updates[at] as usize;
            let (node, of) = (order.index_of_node[forest.node(update)], forest.updates[update]);
            splits.push(Split {
                parent: node | if of.fused_with_child { FLAG } else { 0 },
                second: order.second(
                    at,
                    of.children
                        .map(|child| forest.update_of(child).map(|u| order.index_of_update[u])),
                ),
                local: Local {
                    radius: of.radius,
                    error: forest.error(update),
                    level: of.level | if of.is_open || of.wings == [NONE; 2] { OPEN } else { 0 },
                    wings: of.wings.map(|wing| rank(forest, order, update, wing)),
                },
            });
            if of.wings == [NONE; 2] {
                non_fans.insert(at as u32, non_fan(forest, order, update));
            }
        }
        let wedges = forest.wedges.as_ref();
        let wedges = wedges.map(|wedges| Wedges::in_order(forest, wedges, order)).transpose()?;
        let ordered = if wedges.is_some() { &order.updates[..] } else { &[] };
        let number = |&update: &u32| i32::from(forest.updates[update as usize].stage.number());
        let stages: Vec<i32> = ordered.iter().map(number).collect();
        let positions = order.nodes.iter().map(|&n| forest.positions[n as usize]);
        Ok(Self {
            frame: forest.frame,
            error_kind: forest.error_kind,
            roots: order.trees.len() as u32 - 1,
            trees: order.trees.clone(),
            exact: forest.exact.select(order.nodes.iter().copied()),
            positions: StoredPositions::Float(positions.collect()),
            splits: Splits::Full(splits),
            base: order.base_faces(forest).iter().map(|face| face.nodes).collect(),
            stages: PackedTable::list(&stages),
            wedges: wedges.map(Arc::new),
            non_fan_splits: non_fans,
            full_faces: forest.faces.len(),
        })
    }
}

/// Returns the rank of a wing among the ring nodes that a face follows.
fn rank(forest: &Forest, order: &Order, update: usize, wing: u32) -> u8 {
    if wing == NONE {
        return NO_WING;
    }
    let mut followed = forest.ring(update);
    if forest.updates[update].is_open
        && let Some((&last, rest)) = followed.split_last()
    {
        if wing == last {
            return LAST_WING;
        }
        followed = rest;
    }
    let place = order.index_of_node[wing as usize];
    // Below both codes, or the recorder would have listed the faces.
    followed.iter().filter(|&&other| order.index_of_node[other as usize] < place).count() as u8
}

fn non_fan(forest: &Forest, order: &Order, update: usize) -> NonFanSplit {
    let non_fan = forest.non_fan_splits.get(&(update as u32));
    non_fan.map_or_else(NonFanSplit::default, |non_fan| {
        non_fan.renumbered(|node| order.index_of_node[node as usize])
    })
}
