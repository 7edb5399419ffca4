//! A path cover of the dual graph: which neighbouring faces are drawn one after the other.
//!
//! Faces are *cells*, linked through their sides to at most two others; the linked cells form paths, and each
//! path becomes a strip. All of it is one array of 16 bytes per face: a move of the annealing reads and writes
//! half a dozen cells, so what counts is in how few cache lines they lie.

use meshlod_mesh::VertexId;

use crate::dual::cells;

/// A side of a cell as one word.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Port(u32);

impl Port {
    /// Where there is nothing across.
    pub(crate) const NONE: Port = Port(u32::MAX);

    /// Most cells there can be: the last one's sides would be taken for [`Port::NONE`].
    pub(crate) const MOST_CELLS: usize = (u32::MAX / 4) as usize;

    #[inline]
    pub(crate) fn new(cell: usize, side: usize) -> Self {
        Self((cell as u32) << 2 | side as u32)
    }

    #[inline]
    pub(crate) fn cell(self) -> usize {
        (self.0 >> 2) as usize
    }

    #[inline]
    pub(crate) fn side(self) -> usize {
        (self.0 & 3) as usize
    }

    #[inline]
    pub(crate) fn is_none(self) -> bool {
        self == Self::NONE
    }
}

/// Which sides of a cell are linked: bit k for side k, never more than two.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct Links(u8);

impl Links {
    #[inline]
    pub(crate) fn has(self, side: usize) -> bool {
        self.0 >> side & 1 != 0
    }

    /// With the link of one side made where it is not, cut where it is.
    #[inline]
    pub(crate) fn toggled(self, side: usize) -> Self {
        Self(self.0 ^ 1 << side)
    }

    #[inline]
    pub(crate) fn with(self, side: usize) -> Self {
        Self(self.0 | 1 << side)
    }

    #[inline]
    pub(crate) fn without(self, side: usize) -> Self {
        Self(self.0 & !(1 << side))
    }

    /// How many there are.
    #[inline]
    pub(crate) fn count(self) -> usize {
        (self.bits() & 1) + (self.bits() >> 1 & 1) + (self.bits() >> 2)
    }

    /// The lowest linked side.
    #[inline]
    pub(crate) fn first(self) -> Option<usize> {
        (self.bits() != 0).then(|| self.bits().trailing_zeros() as usize)
    }

    /// As a number below 8, bit k for side k.
    #[inline]
    pub(crate) fn bits(self) -> usize {
        (self.0 & 7) as usize
    }
}

/// A face in a cover: what lies across its sides, and which of them are linked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cell {
    pub(crate) across: [Port; 3],
    pub(crate) links: Links,
    /// Whether its links must stay as they are for now.
    pub(crate) held: bool,
}

impl Cell {
    /// A face with nothing across.
    pub(crate) const ALONE: Self = Self { across: [Port::NONE; 3], links: Links(0), held: false };
}

/// A path cover of some faces.
///
/// Whatever is done to it, a link is known on both its sides, no cell has more than two, and no path closes.
#[derive(Clone, Debug)]
pub(crate) struct Cover {
    pub(crate) cells: Vec<Cell>,
}

impl Cover {
    /// Every face of `faces` a path by itself.
    pub(crate) fn new(faces: &[[VertexId; 3]]) -> Self {
        Self { cells: cells(faces) }
    }

    /// Takes away what lies across between faces with different labels: no strip crosses there.
    ///
    /// Panics unless there is a label for each face.
    pub(crate) fn part(&mut self, labels: &[u32]) {
        assert_eq!(labels.len(), self.cells.len(), "a label for each face");
        for (cell, label) in labels.iter().enumerate() {
            for side in 0..3 {
                let other = self.cells[cell].across[side];
                if !other.is_none() && labels[other.cell()] != *label {
                    self.sever(Port::new(cell, side));
                }
            }
        }
    }

    /// What lies across a side.
    #[inline]
    pub(crate) fn across(&self, port: Port) -> Port {
        self.cells[port.cell()].across[port.side()]
    }

    /// Makes what lies across a side nothing, and cuts its link if there is one.
    pub(crate) fn sever(&mut self, port: Port) {
        let other = self.across(port);
        for port in [port, other].into_iter().filter(|port| !port.is_none()) {
            let cell = &mut self.cells[port.cell()];
            cell.links = cell.links.without(port.side());
            cell.across[port.side()] = Port::NONE;
        }
    }

    /// Lets two sides lie across from each other, unlinked; what they had across before is severed.
    pub(crate) fn join(&mut self, p: Port, q: Port) {
        self.sever(p);
        self.sever(q);
        self.cells[p.cell()].across[p.side()] = q;
        self.cells[q.cell()].across[q.side()] = p;
    }

    /// Links the cells on both sides of `port`, if they may be: both have less than two links, and no path closes.
    /// Whether they are linked now.
    pub(crate) fn link(&mut self, port: Port) -> bool {
        let other = self.across(port);
        if other.is_none() || self.cells[port.cell()].links.has(port.side()) {
            return !other.is_none();
        }
        if !self.is_end(port.cell()) || !self.is_end(other.cell()) || self.same_path(port, other) {
            return false;
        }
        for port in [port, other] {
            let cell = &mut self.cells[port.cell()];
            cell.links = cell.links.with(port.side());
        }
        true
    }

    /// Cuts the link at a side.
    pub(crate) fn unlink(&mut self, port: Port) {
        for port in [port, self.across(port)] {
            let cell = &mut self.cells[port.cell()];
            cell.links = cell.links.without(port.side());
        }
    }

    /// Whether the two cells, which both end paths, end the same one. Cost: the length of the shorter path.
    fn same_path(&self, p: Port, q: Port) -> bool {
        let (mut from_p, mut from_q) = (self.path(p.cell()), self.path(q.cell()));
        let (mut end_p, mut end_q) = (p.cell(), q.cell());
        loop {
            match from_p.next() {
                Some((cell, _)) => end_p = cell,
                None => return end_p == q.cell(),
            }
            match from_q.next() {
                Some((cell, _)) => end_q = cell,
                None => return end_q == p.cell(),
            }
        }
    }

    /// Links the cells of `path` in its order, wherever two in a row lie across from each other and
    /// [`Cover::link`] may.
    pub(crate) fn follow(&mut self, path: impl IntoIterator<Item = usize>) {
        let mut path = path.into_iter();
        let Some(mut before) = path.next() else { return };
        for cell in path {
            let to = |side: &usize| {
                let other = self.cells[before].across[*side];
                !other.is_none() && other.cell() == cell
            };
            if let Some(side) = (0..3).find(to) {
                self.link(Port::new(before, side));
            }
            before = cell;
        }
    }

    /// The cells of the path that ends in `end`, from there on, each with the side it is left by; `None` at the far
    /// end.
    pub(crate) fn path(&self, end: usize) -> impl Iterator<Item = (usize, Option<usize>)> + '_ {
        debug_assert!(self.cells[end].links.count() < 2, "paths are walked from their ends");
        let mut next = Some((end, self.cells[end].links));
        std::iter::from_fn(move || {
            let (cell, onward) = next?;
            let side = onward.first();
            next = side.map(|side| {
                let entry = self.cells[cell].across[side];
                (entry.cell(), self.cells[entry.cell()].links.without(entry.side()))
            });
            Some((cell, side))
        })
    }

    /// Whether a cell ends a path.
    #[inline]
    pub(crate) fn is_end(&self, cell: usize) -> bool {
        self.cells[cell].links.count() < 2
    }
}

#[cfg(test)]
impl Cover {
    /// Panics if anything that always holds does not.
    pub(crate) fn check(&self) {
        let mut on_paths = 0;
        for (c, cell) in self.cells.iter().enumerate() {
            assert!(cell.links.count() <= 2);
            for side in 0..3 {
                let other = cell.across[side];
                assert!(!other.is_none() || !cell.links.has(side));
                if !other.is_none() {
                    assert_eq!(self.across(other), Port::new(c, side));
                    let linked = self.cells[other.cell()].links.has(other.side());
                    assert_eq!(linked, cell.links.has(side));
                }
            }
            if self.is_end(c) {
                let length = self.path(c).count();
                // Each path of two cells or more is met twice.
                on_paths += if length == 1 { 2 } else { length };
            }
        }
        assert_eq!(on_paths, 2 * self.cells.len(), "a path closes");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six faces around a vertex.
    fn wheel() -> Vec<[VertexId; 3]> {
        (0..6).map(|i| [0, i + 1, (i + 1) % 6 + 1].map(VertexId)).collect()
    }

    #[test]
    fn a_ring_of_faces_is_never_closed() {
        let mut cover = Cover::new(&wheel());
        cover.follow([0, 1, 2, 3, 4, 5, 0]);
        cover.check();
        assert_eq!(cover.path(0).map(|(cell, _)| cell).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn no_path_crosses_between_labels() {
        let mut cover = Cover::new(&wheel());
        cover.follow(0..6);
        cover.part(&[0, 0, 1, 1, 1, 2]);
        cover.follow(0..6);
        cover.check();
        let lengths: Vec<_> = [0, 2, 5].map(|end| cover.path(end).count()).into();
        assert_eq!(lengths, [2, 3, 1]);
    }

    #[test]
    fn what_is_severed_can_be_joined_again() {
        let mut cover = Cover::new(&wheel());
        let port = (0..3).map(|side| Port::new(0, side)).find(|p| !cover.across(*p).is_none());
        let port = port.unwrap();
        let other = cover.across(port);
        assert!(cover.link(port));
        cover.sever(port);
        assert!(!cover.link(port));
        cover.join(port, other);
        assert!(cover.link(port));
        cover.check();
    }
}
