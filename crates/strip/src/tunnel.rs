//! The annealing move: tunnelling along an alternating path [Ste01], with swaps and odd starts in
//! the cost.
//!
//! A node that lacks a link takes one to a neighbour. If the neighbour already has two, one of them
//! is cut, and the node at its other end is the next that lacks a link. So the end of a strip
//! moves, two ends meet, or the tunnel returns to the link that it cut first and no end moves at
//! all. The tunnel is kept as soon as its cost is within the limit; otherwise every change is
//! undone.

use crate::dual_node::{DualEdge, Links};
use crate::random::Random;
use crate::region::Region;

/// Largest number of links a tunnel makes. The bunny with 60 moves per face: 1.107 vertices per
/// face with 2, 1.106 with 4, 1.104 with 6, no fewer with 8 or 10.
pub(crate) const MAX_STEPS: usize = 6;

/// Edges whose links were toggled so far, alternately cut and made.
struct Tunnel {
    edges: [DualEdge; 2 * MAX_STEPS + 1],
    count: usize,
}

impl Tunnel {
    #[inline]
    fn push(&mut self, edge: DualEdge) {
        self.edges[self.count] = edge;
        self.count += 1;
    }

    #[inline]
    fn edges(&self) -> &[DualEdge] {
        &self.edges[..self.count]
    }
}

impl Region<'_> {
    /// Tries a tunnel from `start` that may add up to `limit` to the cost. Returns the node it
    /// ended at if it was kept.
    pub(crate) fn try_tunnel(
        &mut self,
        start: usize,
        limit: i32,
        random: &mut Random,
    ) -> Option<usize> {
        if self.node(start).frozen {
            return None;
        }
        let mut tunnel = Tunnel { edges: [DualEdge::NONE; _], count: 0 };
        let came_to = self.dig(start, limit, &mut tunnel, random);
        if came_to.is_some() {
            self.touch(tunnel.edges());
            return came_to;
        }
        for &edge in tunnel.edges() {
            self.flip(edge);
        }
        None
    }

    /// Digs the tunnel for [`Region::try_tunnel`], which undoes it on failure.
    #[inline]
    fn dig(
        &mut self,
        start: usize,
        limit: i32,
        tunnel: &mut Tunnel,
        random: &mut Random,
    ) -> Option<usize> {
        let mut dice = random.bits();
        let mut cost = 0;
        // The node that lacks a link, and the side that must not get it back.
        let (mut head, mut shut) = (start, 3);
        if self.links(start).count() == 2 {
            let here = linked_side(start, self.links(start), &mut dice);
            let there = self.across(here);
            if self.node(there.node()).frozen {
                return None;
            }
            cost += self.toggle(here);
            tunnel.push(here);
            let from = if roll(&mut dice, 2) == 0 { here } else { there };
            (head, shut) = (from.node(), from.side());
        }
        for _ in 0..MAX_STEPS {
            let open = !self.links(head).bits() & 7 & !(1 << shut);
            let side = nth(open, roll(&mut dice, open.count_ones()));
            let here = DualEdge::new(head, side);
            let there = self.across(here);
            if there.is_none() || self.node(there.node()).frozen {
                return None;
            }
            let mut beyond = None;
            if self.links(there.node()).count() == 2 {
                let cut = linked_side(there.node(), self.links(there.node()), &mut dice);
                let freed = self.across(cut);
                if self.node(freed.node()).frozen {
                    return None;
                }
                cost += self.toggle(cut);
                tunnel.push(cut);
                beyond = Some(freed);
            }
            cost += self.toggle(here);
            tunnel.push(here);
            if cost <= limit && self.all_open(tunnel) {
                return Some(beyond.unwrap_or(there).node());
            }
            let freed = beyond?;
            if !self.can_pay(cost, limit) {
                return None;
            }
            (head, shut) = (freed.node(), freed.side());
        }
        None
    }

    /// Returns whether no link of the tunnel closes a path.
    #[inline]
    fn all_open(&self, tunnel: &Tunnel) -> bool {
        let made = |edge: &&DualEdge| self.links(edge.node()).has(edge.side());
        tunnel.edges().iter().filter(made).all(|&edge| self.ends(edge))
    }
}

/// Picks one of the two linked sides of a node.
#[inline]
fn linked_side(node: usize, links: Links, dice: &mut u64) -> DualEdge {
    DualEdge::new(node, nth(links.bits(), roll(dice, 2)))
}

/// Takes a number below `sides` (at most three) from four of the bits; a tunnel draws at most
/// fourteen.
#[inline]
fn roll(dice: &mut u64, sides: u32) -> u32 {
    let face = (*dice & 15) as u32;
    *dice >>= 4;
    (face * sides) >> 4
}

/// Returns the position of the `n`-th set bit.
#[inline]
fn nth(bits: usize, n: u32) -> usize {
    let mut bits = bits;
    for _ in 0..n {
        bits &= bits - 1;
    }
    bits.trailing_zeros() as usize
}
