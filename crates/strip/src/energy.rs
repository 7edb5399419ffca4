//! What a cover costs, so that what a link changes is known from the cells beside it.

use crate::cover::{Links, Port};

/// What strips cost beyond one vertex for each triangle; a thousand vertices at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prices {
    /// A strip: its first two vertices, and a restart if that counts.
    pub strip: f64,
    /// A swap: a vertex said again.
    pub swap: f64,
    /// An end of a strip at which it cannot start without doubling a vertex. A strip has two ends and pays only
    /// if it can start at neither.
    pub odd_end: f64,
}

impl Default for Prices {
    /// Fewest vertices: a restart costs nothing. An odd end costs .4: of the bunny, 60 moves a face, .5 and .3 leave .001
    /// vertices a face more.
    fn default() -> Self {
        Self { strip: 2.0, swap: 1.0, odd_end: 0.4 }
    }
}

impl Prices {
    /// Fewest indices, where a restart between strips is one. The bunny, 1000 moves a face: 1.106 indices and 1.089
    /// vertices a face with 2.5 for a strip, 1.109 and 1.086 without.
    pub fn with_restarts() -> Self {
        Self { strip: 3.0, ..Self::default() }
    }
}

/// The parts of a vertex that prices are told in: whole numbers sum up to the same in any order.
pub(crate) const UNIT: f64 = 256.0;

/// The prices as tables.
#[derive(Clone, Debug)]
pub(crate) struct Energy {
    /// Of a cell, by its links.
    cells: [i32; 8],
    /// Of a link, by how its path goes on beyond both its cells: 4 × [`ONWARD`] of one + that of the other.
    links: [i32; 16],
    most_won_back: i32,
}

/// By the links of a cell and one of them: how the path goes on beyond that cell. 0: it ends. 1: by the next side.
/// 2: by the previous side.
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

/// A price of more vertices counts as so many.
const MOST: f64 = 1000.0;

impl Energy {
    pub(crate) fn new(prices: &Prices) -> Self {
        let units = |price: f64| (price.clamp(-MOST, MOST) * UNIT).round() as i32;
        let (strip, swap, odd) = (units(prices.strip), units(prices.swap), units(prices.odd_end));
        let mut cells = [0; 8];
        for (links, cost) in cells.iter_mut().enumerate() {
            *cost = (strip * (2 - links.count_ones() as i32)) / 2;
        }
        let mut links = [0; 16];
        // Both turn about the same vertex where one goes on by the next side and the other by the previous one.
        (links[4 + 2], links[2 * 4 + 1]) = (swap, swap);
        (links[1], links[4]) = (odd, odd);
        Self { cells, links, most_won_back: strip + swap }
    }

    /// What a link between `p` and `q` costs, by the links of their cells.
    #[inline]
    pub(crate) fn link(&self, p: Port, of_p: Links, q: Port, of_q: Links) -> i32 {
        let onward = |port: Port, links: Links| ONWARD[links.bits()][port.side()] as usize;
        self.links[onward(p, of_p) * 4 + onward(q, of_q)]
    }

    /// What a trail that goes on is expected to win back at most: a strip, where it meets an end, and a swap.
    /// The bunny, 60 moves a face: two swaps less 1.107 vertices a face in .8 s, half a swap less or more 1.104 in .9, no
    /// end to it 1.106 in 1.9.
    #[inline]
    pub(crate) fn most_won_back(&self) -> i32 {
        self.most_won_back
    }

    /// What a cell costs by its links.
    #[inline]
    pub(crate) fn cell(&self, links: Links) -> i32 {
        self.cells[links.bits()]
    }
}

/// Whether a path swaps at a link between `p` and `q`: it turns about the same vertex before and after.
#[inline]
pub(crate) fn swaps(p: Port, of_p: Links, q: Port, of_q: Links) -> bool {
    let onward = |port: Port, links: Links| ONWARD[links.bits()][port.side()];
    onward(p, of_p) + onward(q, of_q) == 3 && onward(p, of_p) != 0 && onward(q, of_q) != 0
}
