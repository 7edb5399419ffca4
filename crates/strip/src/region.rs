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

/// How far a path is walked each way to see that it ends. The bunny, 60 moves a face: 256 leave 1.0941 vertices a face
/// in 1.1 s, 1024 1.0927 in 1.4. A ribbon of 4,000 faces, all one path: 1.7 s and 6.4, and without a limit the square.
const MOST_WALKED: usize = 256;

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

    /// Whether the path through the link at `p` ends somewhere. False also where that is not known, because the
    /// path leaves the region on both sides or is too long both ways: what is so long need not change here.
    pub(crate) fn ends(&self, p: Port) -> bool {
        let q = self.across(p);
        // Both ways at once: an end is as far as the nearer one.
        let (mut ahead, mut behind) = (Some(p), Some(q));
        for _ in 0..MOST_WALKED {
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

#[cfg(test)]
mod tests {
    use meshlod_mesh::VertexId;

    use super::*;
    use crate::cover::Cover;
    use crate::energy::Prices;

    #[test]
    fn an_end_is_looked_for_no_further_than_it_pays() {
        // A ribbon that does not close.
        let faces: Vec<_> = (0..3000u32)
            .map(|i| if i % 2 == 0 { [i, i + 1, i + 2] } else { [i + 1, i, i + 2] })
            .map(|face| face.map(VertexId))
            .collect();
        let mut cover = Cover::new(&faces);
        cover.follow(0..3000);
        let energy = Energy::new(&Prices::default());
        let link =
            |cell: usize, cover: &Cover| Port::new(cell, cover.cells[cell].links.first().unwrap());
        let ports = [10, 1500, 2990].map(|cell| link(cell, &cover));
        let region = Region::new(&mut cover.cells, 0, &energy);
        assert_eq!(ports.map(|port| region.ends(port)), [true, false, true]);
    }
}
