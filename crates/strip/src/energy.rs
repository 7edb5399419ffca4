//! The cost of a path cover, as a sum of local terms, so that a change of a link is priced from its
//! neighbourhood.

use crate::dual_node::{DualEdge, Links};

/// Prices of strips, in vertices sent beyond one per triangle; each is clamped to a thousand.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Prices {
    /// Price of each strip, in vertices: its first two vertices, and a restart if that counts.
    pub strip: f64,
    /// Price of a swap, which repeats a vertex inside a strip, in vertices.
    pub swap: f64,
    /// Price of a strip end that cannot be its start without doubling a vertex, in vertices.
    ///
    /// A strip has two ends and pays only if it can start at neither.
    pub odd_end: f64,
}

impl Default for Prices {
    /// Returns the prices for the fewest vertices, where a restart is free. An odd end costs .4: on
    /// the bunny with 60 moves per face, .5 and .3 leave .001 vertices per face more.
    fn default() -> Self {
        Self { strip: 2.0, swap: 1.0, odd_end: 0.4 }
    }
}

impl Prices {
    /// Returns the prices that give the fewest indices if a primitive restart takes one.
    ///
    /// The bunny, 1000 moves per face: 1.106 indices and 1.089 vertices per face with 2.5 for a
    /// strip, 1.109 and 1.086 without.
    pub fn with_restarts() -> Self {
        Self { strip: 3.0, ..Self::default() }
    }
}

/// Fixed-point units per vertex; integers give the same sum in any order.
pub(crate) const UNIT: f64 = 256.0;

/// Lookup tables of the prices.
#[derive(Clone, Debug)]
pub(crate) struct Energy {
    /// Cost of a node by its links.
    nodes: [i32; 8],
    /// Cost of a link by how its path goes on at both ends: 4 · [`ONWARD`] of one end + [`ONWARD`]
    /// of the other.
    links: [i32; 16],
    max_regain: i32,
}

/// Continuation of a path beyond a node, by the node's links and the side of entry: 0 for an end, 1
/// by the next side, 2 by the previous side.
const ONWARD: [[u8; 4]; 8] = [
    [0, 0, 0, 0],
    [0, 0, 0, 0],
    [0, 0, 0, 0],
    [1, 2, 0, 0],
    [0, 0, 0, 0],
    [2, 0, 1, 0],
    [0, 1, 2, 0],
    [0, 0, 0, 0],
];

/// Largest price, in vertices.
const MAX_PRICE: f64 = 1000.0;

impl Energy {
    pub(crate) fn new(prices: &Prices) -> Self {
        let units = |price: f64| (price.clamp(-MAX_PRICE, MAX_PRICE) * UNIT).round() as i32;
        let (strip, swap, odd) = (units(prices.strip), units(prices.swap), units(prices.odd_end));
        let mut nodes = [0; 8];
        for (links, cost) in nodes.iter_mut().enumerate() {
            *cost = (strip * (2 - links.count_ones() as i32)) / 2;
        }
        let mut links = [0; 16];
        // Both ends turn about the same vertex if one goes on by the next side and the other by the
        // previous one.
        (links[4 + 2], links[2 * 4 + 1]) = (swap, swap);
        (links[1], links[4]) = (odd, odd);
        Self { nodes, links, max_regain: strip + swap }
    }

    /// Returns the cost of a link between `p` and `q`, given the links of their nodes.
    #[inline]
    pub(crate) fn link(&self, p: DualEdge, of_p: Links, q: DualEdge, of_q: Links) -> i32 {
        let onward = |edge: DualEdge, links: Links| ONWARD[links.bits()][edge.side()] as usize;
        self.links[onward(p, of_p) * 4 + onward(q, of_q)]
    }

    /// Maximum that a tunnel is expected to regain by going on: a strip, if it meets an end, and a
    /// swap. The bunny, 60 moves per face: two swaps less give 1.107 vertices per face in .8 s,
    /// half a swap less or more 1.104 in .9 s, no limit 1.106 in 1.9 s.
    #[inline]
    pub(crate) fn max_regain(&self) -> i32 {
        self.max_regain
    }

    /// Returns the cost of a node, given its links.
    #[inline]
    pub(crate) fn node(&self, links: Links) -> i32 {
        self.nodes[links.bits()]
    }
}

/// Returns whether a path swaps at a link between `p` and `q`, that is, turns about the same vertex
/// before and after.
#[inline]
pub(crate) fn swaps(p: DualEdge, of_p: Links, q: DualEdge, of_q: Links) -> bool {
    let onward = |edge: DualEdge, links: Links| ONWARD[links.bits()][edge.side()];
    onward(p, of_p) + onward(q, of_q) == 3 && onward(p, of_p) != 0 && onward(q, of_q) != 0
}
