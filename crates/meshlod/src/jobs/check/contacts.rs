//! Contacts between objects, grouped by pairs of objects.

use std::collections::BTreeMap;

use meshlod_check::{Intersection, IntersectionKind, ObjectId};
use meshlod_mesh::FaceId;

use super::group::is_touch;

/// All contacts between two objects, with the deepest of them.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectPair {
    /// Number of touching face pairs by kind of contact: vertex, edge, crossing, overlap.
    pub counts: [usize; 4],
    /// Intersection of the faces of the deepest contact, or of the first if all depths are 0.
    pub deepest: Intersection,
    /// The two faces of the deepest contact.
    pub faces: [FaceId; 2],
}

/// All kinds of contact with their names, in the order of [`ObjectPair::counts`].
pub const CONTACT_KINDS: [(IntersectionKind, &str); 4] = [
    (IntersectionKind::Point, "vertex"),
    (IntersectionKind::Segment, "edge"),
    (IntersectionKind::Crossing, "crossing"),
    (IntersectionKind::Overlap, "overlap"),
];

/// Contacts of a mesh by pairs of objects that meet.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contacts {
    pairs: BTreeMap<[ObjectId; 2], ObjectPair>,
    /// Number of pairs within copies of a mesh that are counted but not listed, and how many of them
    /// only touch. Each is a repetition of a pair that is listed for another copy.
    unlisted: usize,
    unlisted_touching: usize,
}

impl Contacts {
    pub(super) fn add(&mut self, objects: [ObjectId; 2], faces: [FaceId; 2], touch: Intersection) {
        let new = || ObjectPair { counts: [0; 4], deepest: touch, faces };
        let pair = self.pairs.entry(objects).or_insert_with(new);
        pair.counts[touch.kind as usize] += 1;
        if touch.depth > pair.deepest.depth {
            (pair.deepest, pair.faces) = (touch, faces);
        }
    }

    /// Adds a pair of objects that meet.
    pub(super) fn add_pair(&mut self, objects: [ObjectId; 2], pair: ObjectPair) {
        self.pairs.insert(objects, pair);
    }

    /// Counts pairs of objects that meet as a listed pair does, and are not listed.
    pub(super) fn count_more(&mut self, pair: &ObjectPair, count: usize) {
        self.unlisted += count;
        self.unlisted_touching += if pair.only_touches() { count } else { 0 };
    }

    /// Returns the number of pairs of objects that meet.
    pub fn len(&self) -> usize {
        self.pairs.len() + self.unlisted
    }

    /// Returns the number of pairs of objects that touch, but nowhere pass through each other.
    pub fn touching(&self) -> usize {
        let listed = self.pairs.values().filter(|pair| pair.only_touches()).count();
        listed + self.unlisted_touching
    }

    /// Returns true if no two objects meet.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the pairs of objects, those with the most touching faces first; ties are broken by
    /// object ids. Of copies of a mesh, the first have their pairs listed, at least as many as the
    /// request lists findings.
    pub fn by_size(&self) -> Vec<([ObjectId; 2], &ObjectPair)> {
        let mut pairs: Vec<_> = self.pairs.iter().map(|(&objects, pair)| (objects, pair)).collect();
        pairs.sort_by_key(|(_, pair)| std::cmp::Reverse(pair.faces()));
        pairs
    }
}

impl ObjectPair {
    /// Returns the number of touching face pairs of all objects.
    pub fn faces(&self) -> usize {
        self.counts.iter().sum()
    }

    /// Returns whether the objects touch, but nowhere pass through or lie in each other.
    pub fn only_touches(&self) -> bool {
        CONTACT_KINDS.iter().all(|(kind, _)| is_touch(*kind) || self.counts[*kind as usize] == 0)
    }
}
