//! Contracted vertices: two for an edge, three for a face.

use std::ops::Deref;

use meshlod_mesh::VertexId;

/// Contracted vertices of an edge or a face, as a slice of two or three.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contracted {
    vertices: [VertexId; 3],
    count: u8,
}

impl Contracted {
    /// Builds the pair of an edge's ends.
    #[inline]
    pub fn edge([v0, v1]: [VertexId; 2]) -> Self {
        Self { vertices: [v0, v1, v1], count: 2 }
    }

    /// Builds the triple of a face's corners.
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

/// Freedom of a contraction to place its vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Freedom {
    /// Free to place the vertex anywhere.
    #[default]
    Free,
    /// Restricted to the position of the contracted vertex with this index.
    At(usize),
}

impl Freedom {
    /// Combines two freedoms; `None` if they require different positions.
    #[inline]
    pub(crate) fn and(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Free, only) | (only, Self::Free) => Some(only),
            (a, b) => (a == b).then_some(a),
        }
    }
}
