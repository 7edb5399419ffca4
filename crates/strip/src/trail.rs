//! The move of the annealing: links are made and cut by turns along a trail of cells.
//!
//! A cell that wants a link takes one to a neighbour; if that has two already, one of them is cut, and the cell at
//! the other end of it is the next that wants one. So an end of a strip wanders, two ends meet, or the trail comes
//! back to where its first link was cut and no end was ever there. The trail is kept as soon as it costs no more
//! than it may, else all of it is undone. This is tunnelling [Ste01], with swaps and odd starts in the cost.

use crate::cover::{Links, Port};
use crate::random::Random;
use crate::region::Region;

/// How many links a trail makes at most. The bunny, 60 moves a face: 2 leave 1.107 vertices a face, 4 1.106, 6 1.104,
/// 8 and 10 no less.
pub(crate) const MOST_STEPS: usize = 6;

/// The links made and cut so far.
struct Trail {
    ports: [Port; 2 * MOST_STEPS + 1],
    count: usize,
}

impl Trail {
    #[inline]
    fn push(&mut self, port: Port) {
        self.ports[self.count] = port;
        self.count += 1;
    }

    #[inline]
    fn ports(&self) -> &[Port] {
        &self.ports[..self.count]
    }
}

impl Region<'_> {
    /// Tries one trail from `start`, which may add `limit` to the cost. The cell it came to, if it was kept.
    pub(crate) fn try_trail(
        &mut self,
        start: usize,
        limit: i32,
        random: &mut Random,
    ) -> Option<usize> {
        if self.cell(start).held {
            return None;
        }
        let mut trail = Trail { ports: [Port::NONE; _], count: 0 };
        let came_to = self.follow_trail(start, limit, &mut trail, random);
        if came_to.is_none() {
            for &port in trail.ports() {
                self.flip(port);
            }
        }
        came_to
    }

    /// As [`Region::try_trail`], but leaves it to the caller to undo the trail.
    #[inline]
    fn follow_trail(
        &mut self,
        start: usize,
        limit: i32,
        trail: &mut Trail,
        random: &mut Random,
    ) -> Option<usize> {
        let mut dice = random.bits();
        let mut cost = 0;
        // Where a link is wanted, and the side that must not get it again.
        let (mut head, mut shut) = (start, 3);
        if self.links(start).count() == 2 {
            let here = linked_side(start, self.links(start), &mut dice);
            let there = self.across(here);
            if self.cell(there.cell()).held {
                return None;
            }
            cost += self.toggle(here);
            trail.push(here);
            let from = if roll(&mut dice, 2) == 0 { here } else { there };
            (head, shut) = (from.cell(), from.side());
        }
        for _ in 0..MOST_STEPS {
            let open = !self.links(head).bits() & 7 & !(1 << shut);
            let side = nth(open, roll(&mut dice, open.count_ones()));
            let here = Port::new(head, side);
            let there = self.across(here);
            if there.is_none() || self.cell(there.cell()).held {
                return None;
            }
            let mut beyond = None;
            if self.links(there.cell()).count() == 2 {
                let cut = linked_side(there.cell(), self.links(there.cell()), &mut dice);
                let freed = self.across(cut);
                if self.cell(freed.cell()).held {
                    return None;
                }
                cost += self.toggle(cut);
                trail.push(cut);
                beyond = Some(freed);
            }
            cost += self.toggle(here);
            trail.push(here);
            if cost <= limit && self.all_end(trail) {
                return Some(beyond.unwrap_or(there).cell());
            }
            let freed = beyond?;
            if !self.may_pay(cost, limit) {
                return None;
            }
            (head, shut) = (freed.cell(), freed.side());
        }
        None
    }

    /// Whether no link of the trail closes a path.
    #[inline]
    fn all_end(&self, trail: &Trail) -> bool {
        let made = |port: &&Port| self.links(port.cell()).has(port.side());
        trail.ports().iter().filter(made).all(|&port| self.ends(port))
    }
}

/// One of the two linked sides of a cell.
#[inline]
fn linked_side(cell: usize, links: Links, dice: &mut u64) -> Port {
    Port::new(cell, nth(links.bits(), roll(dice, 2)))
}

/// A number below `sides`, which are three at most, from four of the bits: a trail rolls fourteen times.
#[inline]
fn roll(dice: &mut u64, sides: u32) -> u32 {
    let face = (*dice & 15) as u32;
    *dice >>= 4;
    (face * sides) >> 4
}

/// The `n`-th of the bits that are set.
#[inline]
fn nth(bits: usize, n: u32) -> usize {
    let mut bits = bits;
    for _ in 0..n {
        bits &= bits - 1;
    }
    bits.trailing_zeros() as usize
}
