//! Where around a vertex which of its wedges is at the faces.
//!
//! Most vertices have one wedge: its slot is the vertex's own number, and nothing is kept here. The
//! others are flagged, and have a list of sectors: runs of faces with one wedge, counter-clockwise.

use crate::fast::ring::{Vertices, place_in};
use crate::fast::vertex::Flags;

/// A run of faces around a vertex that have one wedge: from this neighbour on, counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sector {
    pub(super) from: u32,
    pub(super) slot: u32,
}

/// The sectors of the vertices that have several wedges.
#[derive(Default)]
pub(super) struct Seams {
    /// By vertex, which list; nothing at all in a mesh without seams.
    of_vertex: Vec<u32>,
    lists: Vec<Vec<Sector>>,
}

/// The slots of a vertex in the two faces on an edge from it, seen counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sides {
    /// In the face that ends at the neighbour.
    pub(super) before: u32,
    /// In the one that begins there.
    pub(super) after: u32,
}

impl Seams {
    /// The sectors of a vertex; none if it has one wedge in the slot of its own number.
    pub(super) fn of(&self, v: u32) -> &[Sector] {
        match self.of_vertex.get(v as usize) {
            Some(&list) if list != u32::MAX => &self.lists[list as usize],
            _ => &[],
        }
    }

    /// The slots of a vertex, each once.
    pub(super) fn slots(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        let sectors = self.of(v);
        let own = sectors.is_empty().then_some(v);
        let first = |(i, sector): (usize, &Sector)| {
            let before = sectors[..i].iter().any(|other| other.slot == sector.slot);
            (!before).then_some(sector.slot)
        };
        own.into_iter().chain(sectors.iter().enumerate().filter_map(first))
    }

    /// The slots of `v` on both sides of its edge to a neighbour, if they differ.
    #[inline]
    pub(super) fn parted(&self, v: u32, neighbour: u32) -> Option<[u32; 2]> {
        let sectors = self.of(v);
        if sectors.len() < 2 {
            return None;
        }
        let at = sectors.iter().position(|sector| sector.from == neighbour)?;
        let before = if at == 0 { sectors.len() - 1 } else { at - 1 };
        Some([sectors[before].slot, sectors[at].slot])
    }

    /// The slot of the face that begins at a neighbour, if that of the face before is `before`.
    #[inline]
    pub(super) fn next(&self, v: u32, neighbour: u32, before: u32) -> u32 {
        let sector = self.of(v).iter().find(|sector| sector.from == neighbour);
        sector.map_or(before, |sector| sector.slot)
    }

    /// The slots of `v` on both sides of its edge to a neighbour.
    pub(super) fn sides(&self, vertices: &Vertices, v: u32, neighbour: u32) -> Sides {
        if !vertices.get(v).flags.any(Flags::SEAM) {
            return Sides { before: v, after: v };
        }
        let sectors = self.of(v);
        let ring = vertices.settled(v);
        let at = |w: u32| vertices.place_of(ring, w).unwrap_or(0);
        let here = at(neighbour);
        // Of the sectors the one that begins next before, or here.
        let back = |sector: &Sector| (here + ring.len() - at(sector.from)) % ring.len();
        let (mut found, mut least) = (0, usize::MAX);
        for (i, sector) in sectors.iter().enumerate() {
            let back = back(sector);
            if back < least {
                (found, least) = (i, back);
            }
        }
        let after = sectors[found].slot;
        let previous = (found + sectors.len() - 1) % sectors.len();
        let before = if least == 0 { sectors[previous].slot } else { after };
        Sides { before, after }
    }

    /// Gives a vertex these slots, of the face that begins at each of its neighbours. Whether it has
    /// anything but the slot of its own number.
    pub(super) fn set(&mut self, v: u32, faces: &[(u32, u32)], vertices: usize) -> bool {
        let last = faces.len() - 1;
        let begins = |i: usize| faces[i].1 != faces[if i == 0 { last } else { i - 1 }].1;
        let sector = |i: usize| Sector { from: faces[i].0, slot: faces[i].1 };
        let mut sectors: Vec<Sector> = (0..=last).filter(|&i| begins(i)).map(sector).collect();
        if sectors.is_empty() && faces[0].1 != v {
            sectors.push(sector(0));
        }
        let any = !sectors.is_empty();
        if any && self.of_vertex.is_empty() {
            self.of_vertex = vec![u32::MAX; vertices];
        }
        match self.of_vertex.get(v as usize).copied() {
            None => {}
            Some(u32::MAX) if !any => {}
            Some(u32::MAX) => {
                self.of_vertex[v as usize] = self.lists.len() as u32;
                self.lists.push(sectors);
            }
            Some(list) => self.lists[list as usize] = sectors,
        }
        any
    }

    /// A neighbour `gone` of `v` becomes `kept`. Of a wing, whose face with the two goes, `first` is the
    /// one where that face begins: a sector of this face alone is no more. Whether it still has anything
    /// but the slot of its own number.
    pub(super) fn rename(&mut self, v: u32, gone: u32, kept: u32, first: Option<u32>) -> bool {
        let sectors = match self.of_vertex.get(v as usize) {
            Some(&list) if list != u32::MAX => &mut self.lists[list as usize],
            _ => return false,
        };
        if let Some(first) = first {
            let begins = |at: u32| sectors.iter().position(|sector| sector.from == at);
            if let (Some(_), Some(_), Some(at)) = (begins(gone), begins(kept), begins(first)) {
                sectors.remove(at);
            }
        }
        for sector in sectors.iter_mut().filter(|sector| sector.from == gone) {
            sector.from = kept;
        }
        // Where one is gone, those on both sides of it may be of one wedge.
        let mut last = sectors.last().map_or(v, |last| last.slot);
        let single = sectors.iter().all(|sector| sector.slot == last);
        match single {
            true => sectors.truncate(usize::from(last != v)),
            false => {
                sectors.retain(|sector| std::mem::replace(&mut last, sector.slot) != sector.slot)
            }
        }
        !sectors.is_empty()
    }
}

impl Vertices<'_> {
    /// Where in a ring a live vertex is, or one that it has taken the place of.
    pub(super) fn place_of(&self, ring: &[u32], v: u32) -> Option<usize> {
        place_in(ring, v).or_else(|| {
            ring.iter().position(|&w| self.get(w).flags.any(Flags::DEAD) && self.heir_of(w) == v)
        })
    }

    /// The live vertex that this one is or has gone into; nothing is shortened on the way.
    fn heir_of(&self, mut v: u32) -> u32 {
        while self.get(v).flags.any(Flags::DEAD) {
            v = self.get(v).target;
        }
        v
    }
}
