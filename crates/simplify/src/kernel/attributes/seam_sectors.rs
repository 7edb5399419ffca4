//! Where around a vertex which of its wedges is at the faces.
//!
//! Most vertices have one wedge: its slot is the vertex's own number, and nothing is kept here. The
//! others are flagged, and have a list of sectors: runs of faces with one wedge, counter-clockwise.

use crate::kernel::collapse::WedgeSides;
use crate::kernel::mesh::one_ring::{LONG, Vertices, index_in, index_in_ring};
use crate::kernel::mesh::vertex::{RING, VertexFlags};

/// A run of faces around a vertex that have one wedge: from this neighbour on, counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sector {
    pub(crate) from: u32,
    pub(crate) slot: u32,
}

/// The sectors of the vertices that have several wedges.
#[derive(Default)]
pub(crate) struct SeamSectors {
    /// By vertex, which list; nothing at all in a mesh without seams.
    of_vertex: Vec<u32>,
    lists: Vec<Vec<Sector>>,
}

impl SeamSectors {
    /// The sectors of a vertex; none if it has one wedge in the slot of its own number.
    #[inline(always)]
    pub(crate) fn of(&self, v: u32) -> &[Sector] {
        match self.of_vertex.get(v as usize) {
            Some(&list) if list != u32::MAX => &self.lists[list as usize],
            _ => &[],
        }
    }

    /// The slots of `v` on both sides of its edge to a neighbour, if they differ.
    #[inline]
    pub(crate) fn parted(&self, v: u32, neighbour: u32) -> Option<[u32; 2]> {
        parted(self.of(v), neighbour)
    }

    /// The slot of the face that begins at a neighbour, if that of the face before is `before`.
    #[inline]
    pub(crate) fn next(&self, v: u32, neighbour: u32, before: u32) -> u32 {
        let sector = self.of(v).iter().find(|sector| sector.from == neighbour);
        sector.map_or(before, |sector| sector.slot)
    }

    /// The slots of `v` on both sides of its edge to a neighbour.
    #[inline(always)]
    pub(crate) fn sides(&self, vertices: &Vertices, v: u32, neighbour: u32) -> WedgeSides {
        let vertex = vertices.get(v);
        if !vertex.flags.any(VertexFlags::SEAM) {
            return WedgeSides { before: v, after: v };
        }
        let sectors = self.of(v);
        if let [only] = sectors {
            return WedgeSides { before: only.slot, after: only.slot };
        }
        if let Some([before, after]) = parted(sectors, neighbour) {
            return WedgeSides { before, after };
        }
        let slot = match vertex.len {
            LONG => within_long(vertices, sectors, v, neighbour),
            len => within(&vertex.ring, len.into(), sectors, neighbour),
        };
        WedgeSides { before: slot, after: slot }
    }

    /// Gives a vertex these slots, of the face that begins at each of its neighbours. Whether it has
    /// anything but the slot of its own number.
    pub(crate) fn set(&mut self, v: u32, (ring, slots): (&[u32], &[u32]), vertices: usize) -> bool {
        let (own, last) = (slots[0], slots[slots.len() - 1]);
        let any = own != v || slots.iter().any(|&slot| slot != own);
        if any && self.of_vertex.is_empty() {
            self.of_vertex = vec![u32::MAX; vertices];
        }
        let Some(list) = self.of_vertex.get_mut(v as usize) else { return any };
        if *list == u32::MAX {
            if !any {
                return false;
            }
            *list = self.lists.len() as u32;
            self.lists.push(Vec::new());
        }
        let sectors = &mut self.lists[*list as usize];
        sectors.clear();
        let mut before = last;
        for (&from, &slot) in ring.iter().zip(slots) {
            if slot != std::mem::replace(&mut before, slot) {
                sectors.push(Sector { from, slot });
            }
        }
        if any && sectors.is_empty() {
            sectors.push(Sector { from: ring[0], slot: own });
        }
        any
    }

    /// A neighbour `gone` of `v` becomes `kept`. Of a wing, whose face with the two goes, `first` is the
    /// one where that face begins: a sector of this face alone is no more. Whether it still has anything
    /// but the slot of its own number.
    pub(crate) fn rename(&mut self, v: u32, gone: u32, kept: u32, first: Option<u32>) -> bool {
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

/// The slots before and after a neighbour where a sector begins, if they differ.
#[inline(always)]
fn parted(sectors: &[Sector], neighbour: u32) -> Option<[u32; 2]> {
    let mut before = sectors.last()?.slot;
    for sector in sectors {
        if sector.from == neighbour {
            return (before != sector.slot).then_some([before, sector.slot]);
        }
        before = sector.slot;
    }
    None
}

/// The slot at a neighbour in the midst of a sector: of that which begins next before.
#[inline(always)]
fn within(ring: &[u32; RING], len: usize, sectors: &[Sector], neighbour: u32) -> u32 {
    let at = |w: u32| index_in_ring(ring, len, w).unwrap_or(0) as u32;
    let (here, mut least) = (at(neighbour), u64::MAX);
    for sector in sectors {
        let there = at(sector.from);
        let back = if there > here { here + len as u32 - there } else { here - there };
        least = least.min((u64::from(back) << 32) | u64::from(sector.slot));
    }
    least as u32
}

#[cold]
fn within_long(vertices: &Vertices, sectors: &[Sector], v: u32, neighbour: u32) -> u32 {
    let ring = vertices.neighbours(v);
    let at = |w: u32| vertices.index_of_live(ring, w).unwrap_or(0);
    let here = at(neighbour);
    let back = |sector: &&Sector| (here + ring.len() - at(sector.from)) % ring.len();
    sectors.iter().min_by_key(back).map_or(v, |sector| sector.slot)
}

impl Vertices<'_> {
    /// Where in a ring a live vertex is, or one that it has taken the place of.
    pub(crate) fn index_of_live(&self, ring: &[u32], v: u32) -> Option<usize> {
        index_in(ring, v).or_else(|| {
            ring.iter()
                .position(|&w| self.get(w).flags.any(VertexFlags::DEAD) && self.find_live(w) == v)
        })
    }

    /// The live vertex that this one is or has gone into; nothing is shortened on the way.
    fn find_live(&self, mut v: u32) -> u32 {
        while self.get(v).flags.any(VertexFlags::DEAD) {
            v = self.get(v).target;
        }
        v
    }
}
