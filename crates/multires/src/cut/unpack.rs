//! The forest that a packed model could have been made of.

use super::front::{Front, find};
use super::star::Spoke;
use crate::forest::{Forest, NONE, Update};
use crate::implicit::Implicit;

/// Who is who in the forest.
struct Numbers {
    /// The forest's updates, first to last.
    updates: Vec<u32>,
    /// The forest's node of each of the model's.
    nodes: Vec<u32>,
    vertices: usize,
}

impl Forest {
    /// A simplification that gives a model: its updates, the last to be made first.
    ///
    /// Every update is made once to see what is around it. Cost: linear. The model must have a
    /// certificate.
    pub(crate) fn of(mt: &Implicit) -> Self {
        let numbers = Numbers::new(mt);
        let mut positions = vec![[0.0; 3]; mt.node_count()];
        for (&node, &place) in numbers.nodes.iter().zip(mt.positions()) {
            positions[node as usize] = place;
        }
        let mut this = Self {
            frame: *mt.frame(),
            error_kind: mt.error_kind(),
            vertices: numbers.vertices,
            positions,
            updates: Vec::with_capacity(mt.update_count()),
            rings: Vec::new(),
            faces: Vec::with_capacity(mt.full_faces()),
            brought: vec![NONE; mt.base_faces()],
            odd: Default::default(),
        };
        let mut front = Front::new(mt);
        // What it meets last is recorded first.
        let mut rings = Vec::with_capacity(mt.update_count());
        for (u, &update) in numbers.updates.iter().enumerate().rev() {
            let is_split = front.split(update, &mut Vec::new());
            assert!(is_split, "levels are in the order of needs, or there is no certificate");
            rings.push(numbers.update(mt, u, front.last_star()));
            this.brought.resize(front.triangles.places(), u as u32);
        }
        for (u, (update, ring)) in rings.into_iter().rev().enumerate() {
            this.updates.push(Update { ring: this.rings.len() as u32, ..update });
            this.rings.extend(ring);
            if let Some(odd) = mt.odd(numbers.updates[u]) {
                let odd = odd.renumbered(|node| numbers.nodes[node as usize]);
                this.odd.insert(u as u32, odd);
            }
        }
        let leaf = |node: u32| numbers.nodes[node as usize];
        this.faces.extend(front.triangles.iter().map(|(_, nodes)| nodes.map(leaf)));
        this
    }
}

impl Numbers {
    fn new(mt: &Implicit) -> Self {
        let mut updates: Vec<u32> = (0..mt.update_count() as u32).collect();
        // The parts of one that is glued stay together.
        updates.sort_unstable_by_key(|&update| {
            let outer = if mt.is_inner(update) { update - 1 } else { update };
            (mt.level(outer), outer, outer == update)
        });
        let leaves = (0..mt.node_count() as u32).filter(|&node| mt.update_of(node).is_none());
        let mut nodes = vec![NONE; mt.node_count()];
        let mut vertices = 0;
        for leaf in leaves {
            nodes[leaf as usize] = vertices;
            vertices += 1;
        }
        for (u, &update) in updates.iter().enumerate() {
            nodes[mt.parent(update) as usize] = vertices + u as u32;
        }
        Self { updates, nodes, vertices: vertices as usize }
    }

    /// An update and its ring, by what was at its node before it was split.
    fn update(&self, mt: &Implicit, u: usize, star: &[Spoke]) -> (Update, Vec<u32>) {
        let update = self.updates[u];
        let number = |node: u32| self.nodes[node as usize];
        let ball = mt.packed_ball(update, mt.parent(update));
        let wings = if mt.odd(update).is_some() { [None; 2] } else { find(star, mt.wings(update)) };
        // Those whom no face follows last.
        let mut ring = distinct(star.iter().map(|spoke| spoke.a));
        let ends = distinct(star.iter().map(|spoke| spoke.b));
        ring.extend(ends.into_iter().filter(|end| star.iter().all(|spoke| spoke.a != *end)));
        let update = Update {
            children: mt.children(update).map(number),
            wings: wings.map(|wing| wing.map_or(NONE, number)),
            ring: 0,
            level: mt.level(update),
            error: ball.error,
            radius: ball.radius,
            is_open: mt.is_open(update) && mt.odd(update).is_none(),
            either: false,
            glued: mt.is_glued(update),
        };
        (update, ring.into_iter().map(number).collect())
    }
}

fn distinct(nodes: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut nodes: Vec<u32> = nodes.collect();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}
