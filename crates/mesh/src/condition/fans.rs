//! Vertices from links: all corners that linked sides connect are one vertex.
//!
//! docs/notes/splitting.md says how this differs from the other splitters and sewers.

use std::collections::BTreeSet;

use crate::condition::links::Links;
use crate::condition::suspects::Around;
use crate::{Connectivity, FaceId, Side, Twin, UnionFind, VertexId};

/// The vertices of the conditioned mesh.
pub(super) struct FanVertices {
    /// Vertex at each corner, three for each face.
    of_corner: Vec<VertexId>,
    /// Vertices of the input that the copies are of; the copies follow the input's vertices.
    pub(super) copies: Vec<VertexId>,
    /// True for the vertices of the input whose ids are in use.
    is_used: Vec<bool>,
    inputs: usize,
}

/// Returns the index of the corner at an end of a side, 0 for the first.
pub(super) fn corner(side: Side, end: usize) -> usize {
    side.face().index() * 3 + (side.corner() + end) % 3
}

impl FanVertices {
    /// Numbers the vertices. One that came from several of the input has the lowest of their ids,
    /// unless another vertex has it already; then it is a copy.
    ///
    /// Vertices that are no suspects keep their ids.
    pub(super) fn new(around: &Around, links: &Links) -> Self {
        let Around { mesh, is_suspect, .. } = around;
        let mut joined = UnionFind::new(mesh.faces.len() * 3);
        for [a, b] in links.pairs() {
            joined.union(corner(a, 0) as u32, corner(b, 1) as u32);
            joined.union(corner(a, 1) as u32, corner(b, 0) as u32);
        }
        let corners = mesh.faces.as_flattened();
        let mut lowest = corners.to_vec();
        for (i, &v) in corners.iter().enumerate() {
            let root = joined.find(i as u32) as usize;
            lowest[root] = lowest[root].min(v);
        }
        let inputs = mesh.positions.len();
        let mut this = Self {
            of_corner: corners.to_vec(),
            copies: Vec::new(),
            is_used: is_suspect.iter().map(|suspect| !suspect).collect(),
            inputs,
        };
        for (i, v) in corners.iter().enumerate() {
            if !is_suspect[v.index()] {
                continue;
            }
            // The root is the first corner of its vertex.
            let root = joined.find(i as u32) as usize;
            this.of_corner[i] =
                if root == i { this.number(lowest[i]) } else { this.of_corner[root] };
        }
        this
    }

    fn number(&mut self, of: VertexId) -> VertexId {
        if !std::mem::replace(&mut self.is_used[of.index()], true) {
            return of;
        }
        self.copies.push(of);
        VertexId::new(self.inputs + self.copies.len() - 1)
    }

    /// Returns the vertices of all faces.
    pub(super) fn faces(&self) -> Vec<[VertexId; 3]> {
        self.of_corner.as_chunks().0.to_vec()
    }

    /// Returns the vertices at the ends of a side.
    pub(super) fn side_ends(&self, side: Side) -> [VertexId; 2] {
        [0, 1].map(|end| self.of_corner[corner(side, end)])
    }

    /// Returns all vertices at the ends of some sides.
    pub(super) fn ends(&self, sides: &[Side]) -> BTreeSet<VertexId> {
        sides.iter().flat_map(|&side| self.side_ends(side)).collect()
    }

    /// Returns the number of vertices of the input that were merged into others.
    pub(super) fn merged(&self) -> usize {
        self.is_used.iter().filter(|used| !*used).count()
    }

    /// Returns the number of vertices of the input that have copies.
    pub(super) fn split_vertices(&self) -> usize {
        let mut split = self.copies.clone();
        split.sort_unstable();
        split.dedup();
        split.len()
    }

    /// Returns the sides at which this is not a manifold: of edges with more than two faces, or two
    /// that do not agree, and of faces that have lost a corner.
    pub(super) fn odd_sides(&self) -> Vec<Side> {
        let faces = self.faces();
        let connectivity = Connectivity::new(&faces, self.inputs + self.copies.len());
        let is_odd = |&side: &Side| match connectivity.twin(side) {
            Twin::NonManifold => true,
            Twin::Side(twin) => side.ends(&faces) == twin.ends(&faces),
            Twin::Degenerate => true,
            Twin::Boundary => false,
        };
        let sides = (0..faces.len()).flat_map(|f| (0..3).map(move |k| (f, k)));
        sides.map(|(f, k)| Side::new(FaceId::new(f), k)).filter(is_odd).collect()
    }
}
