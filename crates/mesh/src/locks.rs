//! Constraints on simplification.

use crate::VertexId;

/// Freedom of a vertex in simplification.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Lock {
    /// Contracted when its cost is the lowest.
    #[default]
    Free,
    /// Contracted late, because its contractions cost more.
    Protected,
    /// Never moved or removed, though other vertices may be contracted into it. An edge is locked
    /// if both its ends are.
    Locked,
}

/// Constraints on simplification: locks of vertices, and ties between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Locks {
    /// Lock of each vertex; empty if all are free.
    pub of_vertex: Vec<Lock>,
    /// Groups of two or more vertices at the same position, which move together to one position
    /// or not at all. No vertex is in two groups.
    pub ties: Vec<Vec<VertexId>>,
}
