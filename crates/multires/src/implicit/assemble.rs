//! Conversion of a packed model to detached updates and back, as files need it.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::Vec3;
use meshlod_mesh::Frame;

use super::positions::StoredPositions;
use super::splits::{Local, Split, Splits};
use super::{FLAG, Implicit, LAST_WING, NO_WING, OPEN, Order};
use crate::error_kind::ErrorKind;
use crate::forest::MAX_RANKED;
use crate::forest::{MAX_LEVELS, NONE, NonFanSplit, Stage};
use crate::length16::Length16;
use crate::pack::{ExactPositions, PackedTable};
use crate::wedges::{DetachedWedges, WedgeValues};

/// An update taken out of its model. Nodes are numbered roots first, then the children of each
/// update.
#[derive(Clone, Debug)]
pub(crate) struct DetachedUpdate {
    /// Node that the update splits, or [`NONE`] if unknown.
    pub(crate) parent: u32,
    pub(crate) level: u16,
    /// Encoded wings.
    pub(crate) wings: [u8; 2],
    pub(crate) radius: Length16,
    pub(crate) error: Length16,
    pub(crate) stage: Stage,
    pub(crate) is_open: bool,
    /// True if the first child's split forms one face split with this one.
    pub(crate) fused_with_child: bool,
    pub(crate) non_fan: Option<Box<NonFanSplit>>,
    /// Positions of the children, in stored units.
    pub(crate) children: [Vec3; 2],
}

/// Properties of a model as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ModelInfo {
    pub(crate) frame: Frame,
    pub(crate) error_kind: ErrorKind,
    /// True if the stages of updates are known.
    pub(crate) has_stages: bool,
}

/// The coarsest mesh of a model.
#[derive(Clone, Debug, Default)]
pub(crate) struct BaseMesh {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) faces: Vec<[u32; 3]>,
}

impl Implicit {
    /// Returns an update in this model's numbering of nodes.
    pub(crate) fn detached(&self, update: u32) -> DetachedUpdate {
        let (parent, local) = (self.splits.parent(update), self.splits.local(update));
        let Local { radius, error, level, wings } = local;
        DetachedUpdate {
            parent: parent & !FLAG,
            level: level & !OPEN,
            wings,
            radius,
            error,
            stage: self.stage(update).unwrap_or_default(),
            is_open: level & OPEN != 0,
            fused_with_child: parent & FLAG != 0,
            non_fan: self.non_fan_split(update).cloned().map(Box::new),
            children: self.children(update).map(|child| self.stored_position(child).into()),
        }
    }

    /// Returns the coarsest mesh.
    pub(crate) fn base_mesh(&self) -> BaseMesh {
        let roots = (0..self.roots).map(|root| self.stored_position(root).into());
        BaseMesh { positions: roots.collect(), faces: self.base.clone() }
    }

    /// Builds a model from detached updates and exact positions, leaving out updates whose node no
    /// other one creates. Each node may be split only once. Also returns the given nodes in the order
    /// of the model.
    ///
    /// Wings need no change: in every set of updates that is closed upwards, nodes keep their
    /// relative order.
    pub(crate) fn assemble(
        about: ModelInfo,
        base: BaseMesh,
        updates: &[DetachedUpdate],
        exact: &ExactPositions,
        wedges: Option<&DetachedWedges>,
    ) -> (Self, Vec<u32>) {
        let roots = base.positions.len();
        let nodes = roots + 2 * updates.len();
        let splits_of = SplitsOfNodes::new(roots, updates);
        let children = |node: u32| splits_of.children(node);
        let order = Order::of((0..roots as u32).collect(), nodes, updates.len(), children);
        let (mut splits, mut non_fans) = (Vec::with_capacity(order.updates.len()), BTreeMap::new());
        let mut full_faces = base.faces.len();
        let mut places: Vec<_> = base.positions.iter().map(|p| p.to_array()).collect();
        places.reserve_exact(2 * order.updates.len());
        for (at, &u) in order.updates.iter().enumerate() {
            let update = &updates[u as usize];
            places.extend(update.children.map(|child| child.to_array()));
            splits.push(splits_of.split(&order, (at, u), update));
            full_faces += update.created_face_count();
            if let Some(non_fan) = &update.non_fan {
                // Unknown nodes stay unknown.
                let place =
                    |node: u32| order.index_of_node.get(node as usize).copied().unwrap_or(NONE);
                let mut non_fan = non_fan.renumbered(place);
                non_fan.created_faces.retain(|face| !face.contains(&NONE));
                non_fans.insert(at as u32, non_fan);
            }
        }
        let staged = if about.has_stages { &order.updates[..] } else { &[] };
        let number = |&u: &u32| i32::from(updates[u as usize].stage.number());
        let model = Self {
            stages: PackedTable::list(&staged.iter().map(number).collect::<Vec<_>>()),
            frame: about.frame,
            error_kind: about.error_kind,
            roots: roots as u32,
            exact: exact.select(order.nodes.iter().copied()),
            trees: order.trees.clone(),
            positions: StoredPositions::Float(places),
            splits: Splits::Full(splits),
            base: base.faces,
            wedges: wedges.map(|wedges| Arc::new(wedges.assemble(&order))),
            non_fan_splits: non_fans,
            full_faces,
        };
        (model, order.nodes)
    }

    /// Sets the attribute values of a model that was assembled without, and that shares its wedges
    /// with nobody.
    pub(crate) fn set_values(&mut self, values: WedgeValues) {
        if let Some(all) = self.wedges.as_mut().and_then(Arc::get_mut) {
            all.values = values;
        }
    }
}

impl DetachedUpdate {
    /// Returns the number of faces that the update creates.
    pub(crate) fn created_face_count(&self) -> usize {
        let wings = self.wings.iter().filter(|&&wing| wing != NO_WING).count();
        self.non_fan.as_ref().map_or(wings, |non_fan| non_fan.created_faces.len())
    }

    /// Returns the reason why the update cannot be below the given one, or cannot exist at all.
    pub(crate) fn trouble(&self, above: Option<&Self>) -> Option<&'static str> {
        let most = above.map_or(MAX_LEVELS, |above| above.level);
        let is_rank = |wing: u8| usize::from(wing) < MAX_RANKED || wing >= LAST_WING;
        if self.level == 0 || self.level >= most {
            Some("its level is not between 0 and that of the update above it")
        } else if above.is_some_and(|above| above.error < self.error) {
            Some("its error exceeds that of the update above it")
        } else if !self.wings.iter().all(|&wing| is_rank(wing)) {
            Some("the rank of a wing is out of range")
        } else {
            None
        }
    }
}

impl NonFanSplit {
    /// Returns the split with its nodes renumbered.
    pub(crate) fn renumbered(&self, number: impl Fn(u32) -> u32) -> Self {
        Self {
            second: self.second.iter().map(|pair| pair.map(&number)).collect(),
            created_faces: self.created_faces.iter().map(|face| face.map(&number)).collect(),
        }
    }
}

/// Returns true if the three corners of a face are distinct nodes.
pub(crate) fn has_three_corners(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// Detached updates by the node that each splits. The children of update u are the nodes that follow
/// the roots and those of the updates before it.
struct SplitsOfNodes {
    /// Update by the node that it splits, or [`NONE`].
    update_of: Vec<u32>,
    roots: u32,
}

impl SplitsOfNodes {
    fn new(roots: usize, updates: &[DetachedUpdate]) -> Self {
        let mut update_of = vec![NONE; roots + 2 * updates.len()];
        for (u, update) in updates.iter().enumerate().filter(|(_, u)| u.parent != NONE) {
            update_of[update.parent as usize] = u as u32;
        }
        Self { update_of, roots: roots as u32 }
    }

    fn children_of(&self, update: u32) -> [u32; 2] {
        [0, 1].map(|child| self.roots + 2 * update + child)
    }

    /// Returns the update that splits a node, if there is one, and the nodes it creates.
    fn children(&self, node: u32) -> Option<(u32, [u32; 2])> {
        let update = self.update_of[node as usize];
        (update != NONE).then(|| (update, self.children_of(update)))
    }

    /// Returns update `u`, which is the one at `at` in the order of the model, as the model has it.
    fn split(&self, order: &Order, (at, u): (usize, u32), update: &DetachedUpdate) -> Split {
        let below = self.children_of(u).map(|child| {
            self.children(child).map(|(update, _)| order.index_of_update[update as usize])
        });
        // A child that is never split cannot be fused with its parent.
        let fused_with_child = update.fused_with_child && below[0].is_some();
        Split {
            parent: order.index_of_node[update.parent as usize]
                | if fused_with_child { FLAG } else { 0 },
            second: order.second(at, below),
            local: Local {
                radius: update.radius,
                error: update.error,
                level: update.level | if update.is_open { OPEN } else { 0 },
                wings: update.wings,
            },
        }
    }
}
