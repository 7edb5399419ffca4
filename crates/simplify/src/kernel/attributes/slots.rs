//! Values by slot, cut into parts of the surface.
//!
//! The slots of a part are in two runs: those of its vertices, which are the vertices themselves,
//! and those of their further wedges, which follow after the slots of all vertices.

use std::ops::Range;

use crate::kernel::mesh::vertex::NO_VERTEX;

/// The slots of a part: two ranges.
#[derive(Clone, Debug)]
pub(crate) struct SlotRanges {
    pub(crate) vertices: Range<usize>,
    /// Numbers of the further wedges, counted from the first of them.
    pub(crate) others: Range<usize>,
}

/// Values of a part by slot, `width` of them for each.
pub(crate) struct Slots<'p, T> {
    own: &'p mut [T],
    others: &'p mut [T],
    first: u32,
    first_other: u32,
}

impl<'p, T> Slots<'p, T> {
    /// Cuts the values of all slots, `width` for each, into parts. The first `vertices` slots are
    /// those of vertices. Without values each part has none.
    pub(crate) fn cut(
        all: &'p mut [T],
        (vertices, width): (usize, usize),
        parts: &[SlotRanges],
    ) -> Vec<Self> {
        let are_some = !all.is_empty();
        let (mut own, mut others) = all.split_at_mut(if are_some { vertices * width } else { 0 });
        let (mut of_own, mut of_others) = (0, 0);
        let mut cut = Vec::with_capacity(parts.len());
        for part in parts {
            let SlotRanges { vertices: range, others: more } = part;
            let (of_part, of_part_others) = match are_some {
                true => (
                    take(&mut own, &mut of_own, range, width),
                    take(&mut others, &mut of_others, more, width),
                ),
                false => Default::default(),
            };
            cut.push(Self {
                own: of_part,
                others: of_part_others,
                first: range.start as u32,
                first_other: (vertices + more.start) as u32,
            });
        }
        cut
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.own.is_empty()
    }

    /// Returns the value of a vertex's own slot; `None` for one of another part, and for a slot
    /// that is no vertex.
    #[inline(always)]
    pub(crate) fn of_vertex(&self, v: u32) -> Option<&T> {
        self.own.get(v.wrapping_sub(self.first) as usize)
    }

    /// Returns the value of a vertex's own slot for writing.
    #[inline(always)]
    pub(crate) fn of_vertex_mut(&mut self, v: u32) -> &mut T {
        &mut self.own[v.wrapping_sub(self.first) as usize]
    }

    /// Returns the value of a slot; `None` for one of another part.
    #[inline(always)]
    pub(crate) fn get(&self, slot: u32) -> Option<&T> {
        let other = || self.others.get(slot.wrapping_sub(self.first_other) as usize);
        self.of_vertex(slot).or_else(other)
    }

    /// Returns the value of a slot for writing.
    #[inline(always)]
    pub(crate) fn get_mut(&mut self, slot: u32) -> &mut T {
        match self.own.get_mut(slot.wrapping_sub(self.first) as usize) {
            Some(own) => own,
            None => &mut self.others[slot.wrapping_sub(self.first_other) as usize],
        }
    }

    /// Returns all values of a slot with several.
    pub(crate) fn row(&self, slot: u32, width: usize) -> &[T] {
        let at = slot.wrapping_sub(self.first) as usize * width;
        let other = slot.wrapping_sub(self.first_other) as usize * width;
        match self.own.get(at..at + width) {
            Some(row) => row,
            None => &self.others[other..other + width],
        }
    }

    /// Returns all values of a slot with several for writing.
    pub(crate) fn row_mut(&mut self, slot: u32, width: usize) -> &mut [T] {
        let at = slot.wrapping_sub(self.first) as usize * width;
        let other = slot.wrapping_sub(self.first_other) as usize * width;
        match self.own.get_mut(at..at + width) {
            Some(row) => row,
            None => &mut self.others[other..other + width],
        }
    }
}

impl Slots<'_, u32> {
    /// Returns the number at a slot, and [`NO_VERTEX`] for a slot of another part.
    #[inline(always)]
    pub(crate) fn at(&self, slot: u32) -> u32 {
        self.get(slot).copied().unwrap_or(NO_VERTEX)
    }
}

/// Takes the values of a range of slots from those that are left, which begin with slot `at`.
fn take<'p, T>(
    left: &mut &'p mut [T],
    at: &mut usize,
    range: &Range<usize>,
    width: usize,
) -> &'p mut [T] {
    let all = std::mem::take(left);
    let (_, from) = all.split_at_mut((range.start - *at) * width);
    let (taken, rest) = from.split_at_mut(range.len() * width);
    (*left, *at) = (rest, range.end);
    taken
}
