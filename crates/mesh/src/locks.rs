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

impl Locks {
    /// Returns the constraint on a vertex; vertices beyond the list are free.
    #[inline]
    pub fn of(&self, v: VertexId) -> Lock {
        self.of_vertex.get(v.index()).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_without_a_lock_are_free() {
        let locks = Locks { of_vertex: vec![Lock::Free, Lock::Locked], ties: Vec::new() };
        assert_eq!(
            [0, 1, 2].map(|v| locks.of(VertexId(v))),
            [Lock::Free, Lock::Locked, Lock::Free]
        );
        assert_eq!(Locks::default().of(VertexId(0)), Lock::Free);
    }
}
