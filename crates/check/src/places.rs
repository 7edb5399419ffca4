//! Which vertices are at one place.

use std::collections::HashMap;
use std::hash::{BuildHasher, RandomState};

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
        let mut seen = Seen::new(positions);
        Self { first: (0..positions.len()).map(|v| seen.first(VertexId::new(v))).collect() }
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

/// The vertices seen so far, by their places: a table of vertices, searched from where the hash
/// points to.
struct Seen<'a> {
    positions: &'a [[f64; 3]],
    /// The upper half of the hash, and one more than the vertex; 0 where it is empty. Half of the
    /// table is, so that searches are short.
    table: Vec<u64>,
    keys: [u64; 3],
}

impl<'a> Seen<'a> {
    fn new(positions: &'a [[f64; 3]]) -> Self {
        // Drawn anew, so that nobody can choose positions that all point to one entry. What is found
        // does not depend on them.
        let keys = std::array::from_fn(|i| RandomState::new().hash_one(i));
        Self { positions, table: vec![0; (2 * positions.len()).next_power_of_two()], keys }
    }

    /// The first vertex seen at the place of `vertex`, which is seen now.
    #[inline]
    fn first(&mut self, vertex: VertexId) -> VertexId {
        let place = self.place(vertex);
        if place.iter().any(|&x| f64::from_bits(x).is_nan()) {
            return vertex;
        }
        let hash = self.hash(place);
        let last = self.table.len() - 1;
        let mut at = hash as usize & last;
        loop {
            let entry = self.table[at];
            let other = VertexId((entry as u32).wrapping_sub(1));
            if entry == 0 {
                self.table[at] = hash >> 32 << 32 | u64::from(vertex.0 + 1);
                return vertex;
            }
            if entry >> 32 == hash >> 32 && self.place(other) == place {
                return other;
            }
            at = (at + 1) & last;
        }
    }

    /// The bits of a position; 0 for -0.
    #[inline]
    fn place(&self, vertex: VertexId) -> [u64; 3] {
        self.positions[vertex.index()].map(|x| (x + 0.0).to_bits())
    }

    /// Products of 128 bits, folded: every bit of the place has a say in every bit.
    #[inline]
    fn hash(&self, [x, y, z]: [u64; 3]) -> u64 {
        let fold = |a: u64, b: u64| {
            let product = u128::from(a) * u128::from(b);
            product as u64 ^ (product >> 64) as u64
        };
        let [kx, ky, kz] = self.keys;
        fold(fold(x ^ kx, y ^ ky) ^ z, kz | 1)
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
