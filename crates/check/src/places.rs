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
        let mut first = Vec::with_capacity(positions.len());
        for start in (0..positions.len()).step_by(TOGETHER) {
            let vertices = (start..positions.len().min(start + TOGETHER)).map(VertexId::new);
            let mut asked = [Asked::default(); TOGETHER];
            for (asked, vertex) in asked.iter_mut().zip(vertices.clone()) {
                *asked = seen.ask(vertex);
            }
            first.extend(vertices.zip(asked).map(|(vertex, asked)| seen.first(vertex, asked)));
        }
        Self { first }
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

/// Places asked for at a time, so that memory answers together: a table of millions is in no cache.
/// One by one, a mesh of 4.3 million faces takes 2.3 times as long as with 16 or 64 together, one of
/// 0.27 million 2.4 times as long as with 16, three times as long as with 64.
const TOGETHER: usize = 64;

/// The vertices seen so far, by their places: a table of vertices, searched from where the hash
/// points to.
struct Seen<'a> {
    positions: &'a [[f64; 3]],
    /// The upper half of the hash, and one more than the vertex; 0 where it is empty. A third of the
    /// table is, at least, so that searches are short.
    table: Vec<u64>,
    keys: [u64; 3],
}

/// Where a place is to be looked for, and what is there so far.
#[derive(Clone, Copy, Default)]
struct Asked {
    hash: u64,
    entry: u64,
}

impl<'a> Seen<'a> {
    fn new(positions: &'a [[f64; 3]]) -> Self {
        // Drawn anew, so that nobody can choose positions that all point to one entry. What is found
        // does not depend on them.
        let keys = std::array::from_fn(|i| RandomState::new().hash_one(i));
        Self {
            positions,
            table: vec![0; (positions.len() + positions.len() / 2).next_power_of_two()],
            keys,
        }
    }

    #[inline]
    fn ask(&self, vertex: VertexId) -> Asked {
        let hash = self.hash(self.place(vertex));
        Asked { hash, entry: self.table[hash as usize & (self.table.len() - 1)] }
    }

    /// The first vertex seen at the place of `vertex`, which is seen now.
    #[inline]
    fn first(&mut self, vertex: VertexId, Asked { hash, entry }: Asked) -> VertexId {
        let place = self.place(vertex);
        if place.iter().any(|&x| f64::from_bits(x).is_nan()) {
            return vertex;
        }
        let last = self.table.len() - 1;
        let mut at = hash as usize & last;
        // What is there stays; what was not may have come since.
        let mut entry = if entry == 0 { self.table[at] } else { entry };
        loop {
            let other = VertexId((entry as u32).wrapping_sub(1));
            if entry == 0 {
                self.table[at] = hash >> 32 << 32 | u64::from(vertex.0 + 1);
                return vertex;
            }
            if entry >> 32 == hash >> 32 && self.place(other) == place {
                return other;
            }
            at = (at + 1) & last;
            entry = self.table[at];
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
