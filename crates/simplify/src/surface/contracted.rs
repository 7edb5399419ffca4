//! The vertices that a contraction merges: two for an edge, three for a face.

use std::ops::Deref;

use meshlod_mesh::VertexId;

/// The two ends of a contracted edge or three corners of a contracted face, as a slice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Contracted {
    vertices: [VertexId; 3],
    count: u8,
}

impl Contracted {
    /// Creates the pair of the two ends of an edge.
    #[inline]
    pub fn edge([v0, v1]: [VertexId; 2]) -> Self {
        Self { vertices: [v0, v1, v1], count: 2 }
    }

    /// Creates the triple of the three corners of a face.
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

/// Freedom that a contraction has in placing its new vertex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Freedom {
    /// The new vertex may be anywhere.
    #[default]
    Free,
    /// The new vertex must be at the contracted vertex with this index, or on the surface's normal
    /// there: a seam holds it, and its texture must not slide.
    AlongNormal(usize),
    /// The new vertex must be at the position of the contracted vertex with this index.
    At(usize),
}

impl Freedom {
    /// Combines the restrictions of two contractions; `None` if they require different positions.
    #[inline]
    pub(crate) fn and(self, other: Self) -> Option<Self> {
        match (self, other) {
            (Self::Free, only) | (only, Self::Free) => Some(only),
            (Self::AlongNormal(a), Self::AlongNormal(b)) => (a == b).then_some(self),
            (Self::At(a) | Self::AlongNormal(a), Self::At(b) | Self::AlongNormal(b)) => {
                (a == b).then_some(Self::At(a))
            }
        }
    }

    /// Returns the index of the contracted vertex that must remain, if one must.
    #[inline]
    pub fn kept(self) -> Option<usize> {
        match self {
            Self::Free => None,
            Self::AlongNormal(kept) | Self::At(kept) => Some(kept),
        }
    }
}
