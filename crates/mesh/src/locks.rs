//! Constraints on vertices in mesh simplification.

use crate::VertexId;

/// Constraint on a vertex in mesh simplification.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Lock {
    /// Simplification may move or remove the vertex freely.
    #[default]
    Free,
    /// The vertex is more expensive to remove, so that simplification keeps it longer.
    Protected,
    /// The vertex is never moved or removed, though other vertices may be contracted into it.
    ///
    /// An edge is locked if both its ends are.
    Locked,
}

/// Constraints on mesh simplification: locked vertices, and vertices that must stay together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Locks {
    /// Constraint on each vertex; empty if all vertices are free.
    pub of_vertex: Vec<Lock>,
    /// Groups of two or more vertices at the same position, which are moved together or not at all.
    ///
    /// No vertex is in two groups.
    pub ties: Vec<Vec<VertexId>>,
}
