//! Which vertices are at one place.

use std::collections::HashMap;

use meshlod_mesh::VertexId;
use rustc_hash::FxBuildHasher;

/// The vertices of a mesh by their positions, compared to the bit; 0 and -0 are one.
#[derive(Clone, Debug, PartialEq)]
pub struct Places {
    /// The lowest vertex at the place of each.
    first: Vec<VertexId>,
}

impl Places {
    /// The places of all positions; one that is not a number is a place of its own.
    ///
    /// Cost: linear.
    pub fn of(positions: &[[f64; 3]]) -> Self {
        let mut seen = HashMap::with_capacity_and_hasher(positions.len(), FxBuildHasher);
        let first = positions.iter().enumerate().map(|(v, position)| {
            let vertex = VertexId::new(v);
            if position.iter().any(|x| x.is_nan()) {
                return vertex;
            }
            *seen.entry(position.map(|x| (x + 0.0).to_bits())).or_insert(vertex)
        });
        Self { first: first.collect() }
    }

    /// The lowest vertex at the place of `vertex`, maybe itself.
    #[inline]
    pub fn first(&self, vertex: VertexId) -> VertexId {
        self.first[vertex.index()]
    }

    /// The vertices whose place an earlier one has, lowest id first.
    pub fn doubles(&self) -> impl Iterator<Item = VertexId> + '_ {
        (0..self.first.len()).map(VertexId::new).filter(|&v| self.first(v) != v)
    }

    /// The places with two vertices or more among those that `counts`, by their lowest vertex;
    /// the vertices of each lowest id first.
    pub fn shared(&self, counts: impl Fn(VertexId) -> bool) -> Vec<Vec<VertexId>> {
        let mut groups: HashMap<VertexId, Vec<VertexId>, FxBuildHasher> = HashMap::default();
        // Only places that a second vertex names can have two that count.
        for v in self.doubles() {
            groups.entry(self.first(v)).or_default().push(v);
        }
        let mut shared: Vec<Vec<VertexId>> = groups
            .into_iter()
            .map(|(first, rest)| [first].into_iter().chain(rest).filter(|&v| counts(v)).collect())
            .filter(|group: &Vec<VertexId>| group.len() > 1)
            .collect();
        shared.sort_unstable();
        shared
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minus_zero_is_zero_and_nothing_else_is_close_enough() {
        let next = 1.0_f64.next_up();
        let at = [[0.0, 1.0, 0.0], [-0.0, 1.0, 0.0], [0.0, next, 0.0], [0.0, 1.0, -0.0]];
        let places = Places::of(&at);
        assert_eq!(places.shared(|_| true), [[0, 1, 3].map(VertexId)]);
        assert_eq!(places.shared(|v| v != VertexId(0)), [[1, 3].map(VertexId)]);
        assert!(places.shared(|v| v == VertexId(0)).is_empty());
        assert_eq!(places.first(VertexId(2)), VertexId(2));
    }

    #[test]
    fn what_is_not_a_number_is_nowhere() {
        let places = Places::of(&[[f64::NAN; 3], [f64::NAN; 3]]);
        assert!(places.shared(|_| true).is_empty());
    }
}
