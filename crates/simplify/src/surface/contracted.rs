//! The vertices that become one: two for an edge, three for a face.

use std::ops::Deref;

use meshlod_mesh::VertexId;

/// Two or three vertices; reads as a slice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contracted {
    vertices: [VertexId; 3],
    count: u8,
}

impl Contracted {
    /// The ends of an edge.
    #[inline]
    pub fn edge([v0, v1]: [VertexId; 2]) -> Self {
        Self { vertices: [v0, v1, v1], count: 2 }
    }

    /// The corners of a face.
    #[inline]
    pub fn face(vertices: [VertexId; 3]) -> Self {
        Self { vertices, count: 3 }
    }
}

impl Deref for Contracted {
    type Target = [VertexId];

    #[inline]
    fn deref(&self) -> &[VertexId] {
        &self.vertices[..self.count as usize]
    }
}

/// How free a contraction is to place its vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Freedom {
    /// Anywhere.
    #[default]
    Free,
    /// Only where this one of the contracted is.
    At(usize),
}

impl Freedom {
    /// What is left by both; nothing where each leaves another place.
    #[inline]
    pub(crate) fn and(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Free, only) | (only, Self::Free) => Some(only),
            (a, b) => (a == b).then_some(a),
        }
    }
}
