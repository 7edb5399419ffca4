//! What must stay when a mesh is coarsened.

use crate::VertexId;

/// How freely a vertex may be contracted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Lock {
    /// As its cost says.
    #[default]
    Free,
    /// Late: its contractions cost more.
    Protected,
    /// Never: it stays where it is. Others may be contracted into it. An edge is locked when both
    /// its ends are.
    Locked,
}

/// What must stay when a mesh is coarsened: locks of vertices, and ties between them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Locks {
    /// One per vertex; empty when all are free.
    pub of_vertex: Vec<Lock>,
    /// Two or more vertices at one place each: those of a tie move together, to one place, or not
    /// at all. No vertex is in two ties.
    pub ties: Vec<Vec<VertexId>>,
}
