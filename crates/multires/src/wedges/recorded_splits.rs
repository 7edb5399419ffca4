//! Records of the updates next to seams: which wedges their faces get.

use crate::pack::{PackedTable, RankedSet};

/// Records of updates, in local numbers: wedges are counted from the first of their node.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct RecordedSplits {
    updates: RankedSet,
    /// Start of each record, and the end of the last.
    starts: PackedTable,
    numbers: PackedTable,
}

/// Marks a wedge that has lost all its faces, so that it has no parent.
pub(crate) const LOST: u16 = u16::MAX;
/// Stands for [`LOST`] in the table, next to the numbers of wedges.
const LOST_NUMBER: i32 = -1;

/// Record of an update next to a seam, in local numbers.
///
/// It has the parents of the wedges of the first child, then of the second, and then what faces get,
/// in one of two forms:
/// - **continued**: each face around the node gets the first wedge of its child that has the face's
///   wedge for a parent, and each face that the split creates continues one of the two next to it at
///   its wing. The record has a number for each created face: 0 if it continues the one that its wing
///   precedes, 1 if the one that it follows.
/// - **listed**: the wedge that each face around the node has after the split, in the order of its
///   other two nodes, and then the wedges at the corners of the faces that the split creates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SplitRecord<'w> {
    numbers: &'w PackedTable,
    start: u32,
    /// Start of the wedges of faces around, of those of created ones, and the end.
    ends: [u32; 3],
    /// Numbers of a created face: 1 if faces are continued, 3 if they are listed.
    per_created: u32,
}

impl RecordedSplits {
    /// Packs records, which must come by rising update.
    pub(super) fn new(records: impl Iterator<Item = (u32, Vec<u16>)>) -> Self {
        let (mut updates, mut starts, mut numbers) = (RankedSet::default(), vec![0], Vec::new());
        for (update, record) in records {
            updates.push(update);
            let stored = |number| if number == LOST { LOST_NUMBER } else { i32::from(number) };
            numbers.extend(record.into_iter().map(stored));
            starts.push(numbers.len() as i32);
        }
        let (starts, numbers) = (PackedTable::list(&starts), PackedTable::list(&numbers));
        Self { updates, starts, numbers }
    }

    /// Returns true if an update has a record.
    #[inline]
    pub(super) fn contains(&self, update: u32) -> bool {
        self.updates.rank(update).is_some()
    }

    /// Returns the numbers of an update's record.
    pub(super) fn numbers(&self, update: u32) -> Option<impl Iterator<Item = u16> + '_> {
        let [start, end] = self.ends(update)?;
        Some((start..end).map(|at| number(&self.numbers, at)))
    }

    /// Returns the record of an update with these numbers of wedges and faces, cut short where an
    /// uncertified file is.
    #[inline]
    pub(super) fn get(
        &self,
        update: u32,
        wedges: impl FnOnce() -> u32,
        created: impl FnOnce() -> usize,
    ) -> Option<SplitRecord<'_>> {
        let [start, end] = self.ends(update)?;
        let around = start.saturating_add(wedges()).min(end);
        let (left, created) = (end - around, created() as u32);
        let per_created = if left == created { 1 } else { 3 };
        let ends = [around, around + left.saturating_sub(per_created * created), end];
        Some(SplitRecord { numbers: &self.numbers, start, ends, per_created })
    }

    #[inline]
    fn ends(&self, update: u32) -> Option<[u32; 2]> {
        let rank = self.updates.rank(update)?;
        Some([rank, rank + 1].map(|rank| self.starts.at(rank).unwrap_or(0) as u32))
    }

    pub(super) fn bytes(&self) -> usize {
        self.updates.bytes() + self.starts.bytes() + self.numbers.bytes()
    }
}

#[inline]
fn number(numbers: &PackedTable, at: u32) -> u16 {
    // The number that stands for lost wedges becomes the greatest.
    numbers.at(at as usize).unwrap_or(0) as u16
}

impl SplitRecord<'_> {
    /// Returns the parent of one of the children's wedges, counted from the first child's; `None` if
    /// it has none.
    #[inline]
    pub(crate) fn parent(&self, wedge: usize) -> Option<u16> {
        self.at(self.start, self.ends[0], wedge).filter(|&parent| parent != LOST)
    }

    /// Returns true if the wedges of faces follow from those of the faces before the split.
    #[inline]
    pub(crate) fn is_continued(&self) -> bool {
        self.per_created == 1
    }

    /// Returns true if a created face continues the face that its wing follows, and not the one that
    /// it precedes.
    pub(crate) fn follows(&self, face: usize) -> bool {
        self.at(self.ends[1], self.ends[2], face) == Some(1)
    }

    /// Returns the wedge that a listed face around the node has after the split.
    #[inline]
    pub(crate) fn around(&self, face: usize) -> Option<u16> {
        self.at(self.ends[0], self.ends[1], face)
    }

    /// Returns the wedges at the corners of a listed face that the split creates.
    pub(crate) fn created(&self, face: usize) -> Option<[u16; 3]> {
        let corner = |k| self.at(self.ends[1], self.ends[2], 3 * face + k);
        Some([corner(0)?, corner(1)?, corner(2)?])
    }

    /// Returns the numbers of wedges with a parent, of listed faces around and of created faces.
    pub(crate) fn lengths(&self) -> [usize; 3] {
        let [around, created, end] = self.ends;
        let faces = (end - created) / self.per_created;
        [around - self.start, created - around, faces].map(|length| length as usize)
    }

    #[inline]
    fn at(&self, start: u32, end: u32, place: usize) -> Option<u16> {
        (place < (end - start) as usize).then(|| number(self.numbers, start + place as u32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_come_back_in_their_parts() {
        let first = vec![0, LOST, 2, 5, 1, 3, 4, 0, 7];
        let records = [(3, first.clone()), (70, vec![1]), (71, vec![])];
        let all = RecordedSplits::new(records.into_iter());
        assert!(all.contains(3) && all.contains(71) && !all.contains(4));
        assert_eq!(all.numbers(3).unwrap().collect::<Vec<_>>(), first);
        let record = all.get(3, || 3, || 1).unwrap();
        assert_eq!([0, 1, 2, 3].map(|at| record.parent(at)), [Some(0), None, Some(2), None]);
        assert_eq!([0, 2, 3].map(|at| record.around(at)), [Some(5), Some(3), None]);
        assert_eq!([record.created(0), record.created(1)], [Some([4, 0, 7]), None]);
        assert_eq!((record.lengths(), record.is_continued()), ([3, 3, 1], false));
        let short = all.get(70, || 2, || 2).unwrap();
        assert_eq!((short.parent(0), short.parent(1), short.around(0)), (Some(1), None, None));
        assert!(all.get(4, || 1, || 1).is_none());
    }

    #[test]
    fn as_many_numbers_as_created_faces_say_which_these_continue() {
        let all = RecordedSplits::new([(0, vec![0, 1, LOST, 1, 0])].into_iter());
        let record = all.get(0, || 3, || 2).unwrap();
        assert_eq!((record.lengths(), record.is_continued()), ([3, 0, 2], true));
        assert_eq!([0, 1, 2].map(|face| record.follows(face)), [true, false, false]);
        assert!(!all.get(0, || 2, || 1).unwrap().is_continued());
    }
}
