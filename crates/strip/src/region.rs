//! Cells whose links are changed step by step, and what each step costs.

use crate::cover::{Cell, Links, Port};
use crate::energy::{Energy, swaps};

/// Some cells of a cover in a row. Those with a neighbour outside must be held: then what a change costs is seen
/// from cells inside, and regions beside each other can be changed at the same time.
pub(crate) struct Region<'a> {
    cells: &'a mut [Cell],
    /// The cell that `cells` begin with.
    first: usize,
    energy: &'a Energy,
}

impl<'a> Region<'a> {
    pub(crate) fn new(cells: &'a mut [Cell], first: usize, energy: &'a Energy) -> Self {
        Self { cells, first, energy }
    }

    /// The cells it has.
    pub(crate) fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.cells.len()
    }

    #[inline]
    pub(crate) fn cell(&self, cell: usize) -> &Cell {
        &self.cells[cell - self.first]
    }

    #[inline]
    pub(crate) fn links(&self, cell: usize) -> Links {
        self.cell(cell).links
    }

    #[inline]
    pub(crate) fn across(&self, port: Port) -> Port {
        self.cell(port.cell()).across[port.side()]
    }

    /// Whether a trail that has cost so much may still end with a cost below `limit`.
    #[inline]
    pub(crate) fn may_pay(&self, cost: i32, limit: i32) -> bool {
        cost <= limit + self.energy.most_won_back()
    }

    /// Makes the link at `p` where it is not, cuts it where it is; what that adds to the cost.
    #[inline]
    pub(crate) fn toggle(&mut self, p: Port) -> i32 {
        let q = self.across(p);
        let (of_p, of_q) = (self.links(p.cell()), self.links(q.cell()));
        let made = !of_p.has(p.side());
        let link = self.energy.link(p, of_p.with(p.side()), q, of_q.with(q.side()));
        let cost = self.beside(p) + self.beside(q) + if made { link } else { -link };
        self.flip(p);
        cost
    }

    /// [`Region::toggle`] without the cost.
    #[inline]
    pub(crate) fn flip(&mut self, p: Port) {
        for port in [p, self.across(p)] {
            let links = &mut self.cells[port.cell() - self.first].links;
            *links = links.toggled(port.side());
        }
    }

    /// Whether a cell ends a path, or the path swaps beside it.
    pub(crate) fn is_defect(&self, cell: usize) -> bool {
        let links = self.links(cell);
        let swaps = |side| {
            let here = Port::new(cell, side);
            let there = self.across(here);
            swaps(here, links, there, self.links(there.cell()))
        };
        links.count() < 2 || (0..3).any(|side| links.has(side) && swaps(side))
    }

    /// What toggling `p` adds to the cost of its cell and of the cell's other link.
    #[inline]
    fn beside(&self, p: Port) -> i32 {
        let cell = self.cell(p.cell());
        let (old, new) = (cell.links, cell.links.toggled(p.side()));
        let cost = self.energy.cell(new) - self.energy.cell(old);
        let Some(side) = old.without(p.side()).first() else { return cost };
        let here = Port::new(p.cell(), side);
        let there = cell.across[side];
        let of_there = self.links(there.cell());
        cost + self.energy.link(here, new, there, of_there)
            - self.energy.link(here, old, there, of_there)
    }

    /// Whether the path through the link at `p` ends somewhere. False also where that cannot be known, because the
    /// path leaves the region on both sides.
    pub(crate) fn ends(&self, p: Port) -> bool {
        let q = self.across(p);
        // Both ways at once: an end is as far as the nearer one.
        let (mut ahead, mut behind) = (Some(p), Some(q));
        while ahead.is_some() || behind.is_some() {
            for (walker, start) in [(&mut ahead, q), (&mut behind, p)] {
                let Some(entry) = *walker else { continue };
                let cell = self.cell(entry.cell());
                let Some(side) = cell.links.without(entry.side()).first() else { return true };
                let next = cell.across[side];
                if next.cell() == start.cell() {
                    return false;
                }
                *walker = Some(next).filter(|next| self.range().contains(&next.cell()));
            }
        }
        false
    }
}
