//! Hierarchical face clustering [GWH01]: the two clusters with the smallest common box merge next,
//! by its longest side [LCL10].

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use meshlod_mesh::Bounds;

use super::face_graph::FaceGraph;

/// Sequence of merges, which contains a clustering for every number of clusters.
#[derive(Clone, Debug)]
pub(super) struct Merges {
    faces: usize,
    /// One face of each of the two clusters that merge.
    pairs: Vec<[u32; 2]>,
    /// Longest side of the largest box after each merge.
    sides: Vec<f64>,
}

impl Merges {
    /// Merges until one cluster is left: neighbours first, then connected components.
    ///
    /// Cost: O(n log n) for each doubling of a cluster.
    pub(super) fn new(graph: &FaceGraph) -> Self {
        let mut forming = Clusters::new(graph);
        let neighbours = |f: u32| graph.neighbours(f).filter(move |&other| f < other);
        let faces = 0..graph.faces() as u32;
        forming.merge(faces.clone().flat_map(|f| neighbours(f).map(move |other| [f, other])));
        // The remaining components, in the graph's order, in which near ones are mostly adjacent.
        let apart: Vec<u32> = faces.filter(|&f| forming.root(f) == f).collect();
        forming.merge(apart.windows(2).map(|pair| [pair[0], pair[1]]));
        Self { faces: graph.faces(), pairs: forming.pairs, sides: forming.sides }
    }

    /// Returns the number of clusters when no box may be longer than `side`.
    pub(super) fn count_within(&self, side: f64) -> usize {
        self.faces - self.sides.partition_point(|&of| of <= side)
    }

    /// Returns the cluster of each face, numbered by first faces, for `count` clusters or as many
    /// as there are faces.
    pub(super) fn clusters(&self, count: usize) -> Vec<u32> {
        let mut parents: Vec<u32> = (0..self.faces as u32).collect();
        for &[a, b] in &self.pairs[..self.faces.saturating_sub(count.max(1))] {
            let (a, b) = (root(&mut parents, a), root(&mut parents, b));
            parents[a.max(b) as usize] = a.min(b);
        }
        let mut numbers = vec![u32::MAX; self.faces];
        let mut next = 0;
        let mut number = |face: u32| {
            let first = root(&mut parents, face) as usize;
            if numbers[first] == u32::MAX {
                numbers[first] = next;
                next += 1;
            }
            numbers[first]
        };
        (0..self.faces as u32).map(&mut number).collect()
    }
}

/// Clusters while they are merged.
struct Clusters {
    parents: Vec<u32>,
    /// Box of each cluster, at the index of its least face.
    boxes: Vec<Bounds>,
    pairs: Vec<[u32; 2]>,
    sides: Vec<f64>,
}

impl Clusters {
    fn new(graph: &FaceGraph) -> Self {
        let faces = 0..graph.faces() as u32;
        Self {
            parents: faces.clone().collect(),
            boxes: faces.map(|f| *graph.face_box(f)).collect(),
            pairs: Vec::new(),
            sides: Vec::new(),
        }
    }

    fn root(&mut self, face: u32) -> u32 {
        root(&mut self.parents, face)
    }

    /// Merges pairs, the smallest common box first, until each pair is in one cluster.
    fn merge(&mut self, pairs: impl Iterator<Item = [u32; 2]>) {
        let mut waiting = WaitingPairs::default();
        pairs.for_each(|pair| waiting.push((self.side(pair), pair)));
        while let Some((side, pair)) = waiting.pop() {
            let [a, b] = pair.map(|face| self.root(face));
            if a == b {
                continue;
            }
            // Boxes only grow: if this one has not, it is the smallest.
            let now = self.side([a, b]);
            if now > side {
                waiting.push((now, [a, b]));
                continue;
            }
            let (first, second) = (a.min(b), a.max(b));
            let other = self.boxes[second as usize];
            self.boxes[first as usize].merge(&other);
            self.parents[second as usize] = first;
            self.pairs.push([a, b]);
            let longest = self.sides.last().copied().unwrap_or(0.0);
            self.sides.push(longest.max(f64::from_bits(side)));
        }
    }

    /// Returns the longest side of two clusters' common box, as bits, which sort like lengths.
    fn side(&self, [a, b]: [u32; 2]) -> u64 {
        let mut both = self.boxes[a as usize];
        both.merge(&self.boxes[b as usize]);
        super::longest_side(&both).to_bits()
    }
}

/// Common side of two clusters, as bits, and a face of each.
type WaitingPair = (u64, [u32; 2]);

/// Priority queue of pairs, the least first.
///
/// Only pairs of about the least side are in a heap: one of all pairs of a million faces is larger
/// than a cache, and took three times as long.
#[derive(Default)]
struct WaitingPairs {
    now: BinaryHeap<Reverse<WaitingPair>>,
    /// Level of the sides in the heap.
    level: u64,
    /// Pairs of greater levels.
    later: BTreeMap<u64, Vec<Reverse<WaitingPair>>>,
}

/// Low bits of a side that its level leaves out: a level is a sixteenth of an octave.
const WITHIN_LEVEL: u32 = f64::MANTISSA_DIGITS - 1 - 4;

impl WaitingPairs {
    fn push(&mut self, pair: WaitingPair) {
        match pair.0 >> WITHIN_LEVEL {
            level if level <= self.level => self.now.push(Reverse(pair)),
            level => self.later.entry(level).or_default().push(Reverse(pair)),
        }
    }

    fn pop(&mut self) -> Option<WaitingPair> {
        while self.now.is_empty() {
            let (level, pairs) = self.later.pop_first()?;
            (self.level, self.now) = (level, pairs.into());
        }
        self.now.pop().map(|Reverse(pair)| pair)
    }
}

fn root(parents: &mut [u32], mut face: u32) -> u32 {
    while parents[face as usize] != face {
        let above = parents[parents[face as usize] as usize];
        parents[face as usize] = above;
        face = above;
    }
    face
}

#[cfg(test)]
mod tests {
    use meshlod_fixtures::{grid, two_objects};

    use super::*;

    #[test]
    fn there_are_as_many_clusters_as_asked() {
        for mesh in [grid(8), two_objects()] {
            let graph = FaceGraph::new(&mesh);
            let merges = Merges::new(&graph);
            for count in [1, 2, 3, 7, mesh.faces.len(), mesh.faces.len() + 5] {
                let clusters = merges.clusters(count);
                let found = clusters.iter().max().unwrap() + 1;
                assert_eq!(found as usize, count.min(mesh.faces.len()));
            }
        }
    }

    #[test]
    fn four_clusters_of_a_square_are_its_quarters() {
        let mesh = grid(8);
        let graph = FaceGraph::new(&mesh);
        let clusters = Merges::new(&graph).clusters(4);
        let whole = Bounds::of(&mesh.positions);
        for cluster in 0..4 {
            let faces = (0..).zip(&clusters).filter(|(_, of)| **of == cluster);
            let mut around = Bounds::EMPTY;
            faces.for_each(|(f, _)| around.merge(graph.face_box(f)));
            let side = super::super::longest_side(&around);
            assert!(side < 0.8 * super::super::longest_side(&whole), "{side}");
        }
    }
}
