//! Contacts by the pair of objects that meet.

use std::collections::BTreeMap;

use meshlod::check::{ObjectId, Touch, TouchKind};
use meshlod::mesh::FaceId;

/// How two objects meet.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Pairs of faces by the kind of their touch: vertex, edge, crossing, overlap.
    pub counts: [usize; 4],
    /// The deepest of all, or the first where none is deep.
    pub deepest: Touch,
    /// Its faces.
    pub faces: [FaceId; 2],
}

/// Every kind of touch, in the order of [`Pair::counts`].
pub const KINDS: [(TouchKind, &str); 4] = [
    (TouchKind::Vertex, "vertex"),
    (TouchKind::Edge, "edge"),
    (TouchKind::Crossing, "crossing"),
    (TouchKind::Overlap, "overlap"),
];

/// All pairs of objects that meet.
#[derive(Clone, Debug, Default)]
pub struct Contacts(BTreeMap<[ObjectId; 2], Pair>);

impl Contacts {
    pub fn add(&mut self, objects: [ObjectId; 2], faces: [FaceId; 2], touch: Touch) {
        let new = || Pair { counts: [0; 4], deepest: touch, faces };
        let pair = self.0.entry(objects).or_insert_with(new);
        pair.counts[touch.kind as usize] += 1;
        if touch.depth > pair.deepest.depth {
            (pair.deepest, pair.faces) = (touch, faces);
        }
    }

    /// How many pairs of objects.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Those with the most face pairs first; of equal ones the lower objects.
    pub fn by_size(&self) -> Vec<([ObjectId; 2], &Pair)> {
        let mut pairs: Vec<_> = self.0.iter().map(|(&objects, pair)| (objects, pair)).collect();
        pairs.sort_by_key(|(_, pair)| std::cmp::Reverse(pair.faces()));
        pairs
    }
}

impl Pair {
    /// How many pairs of faces.
    pub fn faces(&self) -> usize {
        self.counts.iter().sum()
    }
}
