//! Constraints on vertices in mesh simplification.

use crate::VertexId;

/// Constraint on a vertex in mesh simplification.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
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
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
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

    /// Returns locks for a mesh of `vertices` vertices that lock every tied vertex in place of tying
    /// it, where vertices cannot be moved together.
    pub fn with_ties_locked(&self, vertices: usize) -> Self {
        let mut of_vertex = self.of_vertex.clone();
        if !self.ties.is_empty() && of_vertex.is_empty() {
            of_vertex.resize(vertices, Lock::Free);
        }
        for v in self.ties.iter().flatten() {
            // A tie of a vertex that is not there is left to the simplifier to refuse.
            if let Some(lock) = of_vertex.get_mut(v.index()) {
                *lock = Lock::Locked;
            }
        }
        Self { of_vertex, ties: Vec::new() }
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

    #[test]
    fn ties_can_be_locked_instead() {
        let ties = vec![[0, 2].map(VertexId).to_vec()];
        let of_vertex = vec![Lock::Free, Lock::Protected, Lock::Protected];
        let locks = Locks { of_vertex, ties: ties.clone() }.with_ties_locked(3);
        assert_eq!(locks.of_vertex, [Lock::Locked, Lock::Protected, Lock::Locked]);
        assert!(locks.ties.is_empty());
        let bare = Locks { of_vertex: Vec::new(), ties }.with_ties_locked(4);
        assert_eq!(bare.of_vertex, [Lock::Locked, Lock::Free, Lock::Locked, Lock::Free]);
        assert_eq!(Locks::default().with_ties_locked(4), Locks::default());
    }
}
