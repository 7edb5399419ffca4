//! Reconstruction of a contraction forest from a packed model.

use super::front::{Front, resolve_wings};
use super::triangles::Spoke;
use super::unpack_wedges::NodeNumbers;
use crate::forest::by_level;
use crate::forest::{Forest, NONE, Update};
use crate::implicit::Implicit;

/// Maps between the numbers of the forest and those of the model.
struct Numbering {
    /// Model update of each forest update, first to last.
    updates: Vec<u32>,
    /// Forest node of each model node.
    nodes: Vec<u32>,
    /// Leaves of the model, which become the first nodes of the forest.
    leaves: Vec<u32>,
}

impl Forest {
    /// Builds a forest that packs to the given model, which must be certified.
    ///
    /// Every update is applied once to see its ring.
    /// Cost: linear.
    pub(crate) fn from_implicit(mt: &Implicit) -> Self {
        let numbers = Numbering::new(mt);
        let mut positions = vec![[0.0; 3]; mt.node_count()];
        for (&to, node) in numbers.nodes.iter().zip(0..) {
            positions[to as usize] = mt.stored_position(node);
        }
        let mut this = Self {
            frame: *mt.frame(),
            error_kind: mt.error_kind(),
            vertices: numbers.leaves.len(),
            positions,
            exact: mt.exact().select(numbers.leaves.iter().copied()),
            updates: Vec::with_capacity(mt.update_count()),
            rings: Vec::new(),
            faces: Vec::with_capacity(mt.full_faces()),
            created_by: vec![NONE; mt.base_faces()],
            non_fan_splits: Default::default(),
            wedges: None,
            posing: None,
        };
        let in_model = numbers.leaves.iter().copied();
        let in_model = in_model.chain(numbers.updates.iter().map(|&update| mt.parent(update)));
        let names = NodeNumbers { in_model: in_model.collect(), in_forest: &numbers.nodes };
        let mut wedges = mt.wedges().map(|all| (names.unpacked(all), all));
        let mut front = Front::new(mt);
        // Refinement meets the updates in reverse.
        let (mut rings, mut room, mut first) = (Vec::new(), Default::default(), Vec::new());
        for (u, &update) in numbers.updates.iter().enumerate().rev() {
            let is_split = front.split(update, &mut first);
            assert!(is_split, "levels are in the order of needs, or there is no certificate");
            let of = numbers.update(mt, update, front.last_star());
            if let Some((wedges, all)) = &mut wedges {
                let created = this.created_by.len() as u32;
                names.unpack((wedges, all), &front, (update, u as u32), created);
            }
            this.updates.push(Update { ring: rings.len() as u32, ..of });
            numbers.append_ring(front.last_star(), &mut room, &mut rings);
            this.created_by.resize(front.triangles.slots(), u as u32);
            if let Some(non_fan) = mt.non_fan_split(update) {
                let non_fan = non_fan.renumbered(|node| numbers.nodes[node as usize]);
                this.non_fan_splits.insert(u as u32, non_fan);
            }
        }
        this.updates.reverse();
        let mut end = rings.len();
        this.rings.reserve_exact(end);
        for update in &mut this.updates {
            let start = std::mem::replace(&mut update.ring, this.rings.len() as u32) as usize;
            this.rings.extend(&rings[start..std::mem::replace(&mut end, start)]);
        }
        let leaf = |node: u32| numbers.nodes[node as usize];
        this.faces.extend(front.triangles.iter().map(|(_, nodes)| nodes.map(leaf)));
        this.wedges = wedges.map(|(mut wedges, all)| {
            let faces = front.triangles.iter();
            let corners = |(t, _)| names.corners((&wedges, all), &front.triangles, t);
            wedges.corners = faces.map(corners).collect();
            wedges
        });
        this
    }
}

impl Numbering {
    fn new(mt: &Implicit) -> Self {
        let mut updates = by_level(mt.update_count(), |update| {
            mt.level(if mt.is_fused_with_parent(update) { update - 1 } else { update })
        });
        // Fused updates stay together, the inner one first.
        let mut at = 0;
        while at < updates.len() {
            let is_fused_with_child = mt.is_fused_with_child(updates[at]);
            if is_fused_with_child {
                updates.swap(at, at + 1);
            }
            at += if is_fused_with_child { 2 } else { 1 };
        }
        let all = 0..mt.node_count() as u32;
        let leaves: Vec<u32> = all.filter(|&node| mt.update_of(node).is_none()).collect();
        let mut nodes = vec![NONE; mt.node_count()];
        let numbered = leaves.iter().copied().chain(updates.iter().map(|&u| mt.parent(u)));
        (0..).zip(numbered).for_each(|(number, node)| nodes[node as usize] = number);
        Self { updates, nodes, leaves }
    }

    /// Converts an update, except for its ring, given the star of its node before the split.
    fn update(&self, mt: &Implicit, update: u32, star: &[Spoke]) -> Update {
        let number = |node: u32| self.nodes[node as usize];
        let ball = mt.packed_ball(update, mt.parent(update));
        let wings = if mt.non_fan_split(update).is_some() {
            [None; 2]
        } else {
            resolve_wings(star, mt.wings(update))
        };
        Update {
            children: mt.children(update).map(number),
            wings: wings.map(|wing| wing.map_or(NONE, number)),
            ring: 0,
            level: mt.level(update),
            error: ball.error,
            radius: ball.radius,
            stage: mt.stage(update).unwrap_or_default(),
            is_open: mt.is_open(update) && mt.non_fan_split(update).is_none(),
            children_swappable: false,
            fused_with_child: mt.is_fused_with_child(update),
        }
    }

    /// Appends the ring of a split: first the nodes that a face follows, then the others, each
    /// sorted.
    fn append_ring(
        &self,
        star: &[Spoke],
        [followed, others]: &mut [Vec<u32>; 2],
        ring: &mut Vec<u32>,
    ) {
        keep_distinct(star.iter().map(|spoke| spoke.a), followed);
        let is_followed = |node: &u32| followed.binary_search(node).is_ok();
        keep_distinct(star.iter().map(|spoke| spoke.b).filter(|b| !is_followed(b)), others);
        ring.extend(followed.iter().chain(&*others).map(|&node| self.nodes[node as usize]));
    }
}

fn keep_distinct(nodes: impl Iterator<Item = u32>, distinct: &mut Vec<u32>) {
    distinct.clear();
    distinct.extend(nodes);
    distinct.sort_unstable();
    distinct.dedup();
}
