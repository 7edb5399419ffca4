//! Contacts grouped by pairs of objects.

use std::collections::BTreeMap;

use meshlod::check::{Intersection, IntersectionKind, ObjectId};
use meshlod::mesh::FaceId;

/// Contacts between two objects.
#[derive(Clone, Debug)]
pub struct ObjectPair {
    /// Number of face pairs by kind of touch: vertex, edge, crossing, overlap.
    pub counts: [usize; 4],
    /// Deepest touch, or the first if none has depth.
    pub deepest: Intersection,
    /// Faces of the deepest touch.
    pub faces: [FaceId; 2],
}

/// Every kind of touch, in the order of [`ObjectPair::counts`].
pub const KINDS: [(IntersectionKind, &str); 4] = [
    (IntersectionKind::Point, "vertex"),
    (IntersectionKind::Segment, "edge"),
    (IntersectionKind::Crossing, "crossing"),
    (IntersectionKind::Overlap, "overlap"),
];

/// All pairs of objects that meet.
#[derive(Clone, Debug, Default)]
pub struct Contacts(BTreeMap<[ObjectId; 2], ObjectPair>);

impl Contacts {
    pub fn add(&mut self, objects: [ObjectId; 2], faces: [FaceId; 2], touch: Intersection) {
        let new = || ObjectPair { counts: [0; 4], deepest: touch, faces };
        let pair = self.0.entry(objects).or_insert_with(new);
        pair.counts[touch.kind as usize] += 1;
        if touch.depth > pair.deepest.depth {
            (pair.deepest, pair.faces) = (touch, faces);
        }
    }

    /// Returns the number of object pairs.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns the pairs with the most face pairs first; ties by object ids.
    pub fn by_size(&self) -> Vec<([ObjectId; 2], &ObjectPair)> {
        let mut pairs: Vec<_> = self.0.iter().map(|(&objects, pair)| (objects, pair)).collect();
        pairs.sort_by_key(|(_, pair)| std::cmp::Reverse(pair.faces()));
        pairs
    }
}

impl ObjectPair {
    /// Returns the number of face pairs.
    pub fn faces(&self) -> usize {
        self.counts.iter().sum()
    }
}
