//! The slot of a vertex in each of the faces around it.
//!
//! Most vertices have one wedge: its slot is the vertex's own id, and nothing is stored here. The
//! others are flagged and have a list of sectors, which are runs of faces with one wedge,
//! counter-clockwise.

use crate::kernel::attributes::slots::Slots;
use crate::kernel::collapse::WedgeSides;
use crate::kernel::mesh::one_ring::{LONG, Vertices, index_in, index_in_ring};
use crate::kernel::mesh::vertex::{RING, VertexFlags};

/// A run of faces around a vertex with one wedge, counter-clockwise from the neighbour `from`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sector {
    pub(crate) from: u32,
    pub(crate) slot: u32,
}

/// Value in place of the index of a list for a vertex that has none.
pub(crate) const NO_LIST: u32 = u32::MAX;

/// Sectors of the vertices of a part that have several wedges.
pub(crate) struct SeamSectors<'p> {
    /// Index of each vertex's list; empty in a mesh without seams.
    pub(crate) of_vertex: Slots<'p, u32>,
    pub(crate) lists: &'p mut Vec<Vec<Sector>>,
}

impl SeamSectors<'_> {
    /// Returns the sectors of a vertex; none if it has one wedge in the slot of its own id.
    #[inline(always)]
    pub(crate) fn of(&self, v: u32) -> &[Sector] {
        match self.of_vertex.of_vertex(v) {
            Some(&list) if list != NO_LIST => &self.lists[list as usize],
            _ => &[],
        }
    }

    /// Returns the slots of `v` on the two sides of its edge to a neighbour, if they differ.
    #[inline]
    pub(crate) fn parted(&self, v: u32, neighbour: u32) -> Option<[u32; 2]> {
        parted(self.of(v), neighbour)
    }

    /// Returns the slot of the face that begins at a neighbour; `before` is that of the preceding
    /// face.
    #[inline]
    pub(crate) fn next(&self, v: u32, neighbour: u32, before: u32) -> u32 {
        let sector = self.of(v).iter().find(|sector| sector.from == neighbour);
        sector.map_or(before, |sector| sector.slot)
    }

    /// Returns the slots of `v` on the two sides of its edge to a neighbour.
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

    /// Sets the slots of a vertex, given for the face that begins at each neighbour. Returns
    /// whether there is any slot other than its own id.
    pub(crate) fn set(&mut self, v: u32, (ring, slots): (&[u32], &[u32])) -> bool {
        let (own, last) = (slots[0], slots[slots.len() - 1]);
        let any = own != v || slots.iter().any(|&slot| slot != own);
        let list = self.of_vertex.of_vertex_mut(v);
        if *list == NO_LIST {
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

    /// Replaces the neighbour `gone` of `v` by `kept`. If `v` is a wing, `first` is the neighbour
    /// where its dying face begins; a sector of that face alone is removed. Returns whether there
    /// is still any slot other than its own id.
    pub(crate) fn rename(&mut self, v: u32, gone: u32, kept: u32, first: Option<u32>) -> bool {
        let sectors = match self.of_vertex.of_vertex(v) {
            Some(&list) if list != NO_LIST => &mut self.lists[list as usize],
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
        // Where a sector is gone, the ones on its two sides may have the same wedge.
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

/// Returns the slots before and after a neighbour where a sector begins, if they differ.
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

/// Returns the slot at a neighbour inside a sector: that of the last sector that begins before it.
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
    /// Returns the index in a ring of a live vertex, or of a dead one contracted into it.
    pub(crate) fn index_of_live(&self, ring: &[u32], v: u32) -> Option<usize> {
        index_in(ring, v).or_else(|| {
            ring.iter()
                .position(|&w| self.get(w).flags.any(VertexFlags::DEAD) && self.find_live(w) == v)
        })
    }

    /// Returns the live vertex that `v` is or has been contracted into, without shortening the
    /// path.
    fn find_live(&self, mut v: u32) -> u32 {
        while self.get(v).flags.any(VertexFlags::DEAD) {
            v = self.get(v).target;
        }
        v
    }
}
