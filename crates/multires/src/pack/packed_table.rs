//! Table of integers that takes few bits where numbers of neighbouring rows are near each other.

use super::bit_words::{WORD, bits_of, number_at, put, range};
use super::packed_rows::PackedRows;

/// Rows of 32-bit integers in blocks; each column of a block has its own range.
///
/// In a block a column takes as many words as its numbers have bits, and none if they are equal.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PackedTable {
    rows: usize,
    columns: usize,
    /// For each block its first word, then the least number and the bits of each column.
    blocks: PackedRows,
    /// The numbers, padded so that each lies within two existing words.
    words: Vec<u64>,
}

/// Rows of a block: the bits of a word, so that each column of a block is of whole words.
const BLOCK: usize = WORD;

impl PackedTable {
    /// Packs rows of `columns` numbers, in the given order.
    pub(crate) fn new<'n>(columns: usize, mut rows: impl Iterator<Item = &'n [i32]>) -> Self {
        let (mut heads, mut this) = (Vec::new(), Self { columns, ..Self::default() });
        let mut block: Vec<&[i32]> = Vec::with_capacity(BLOCK);
        loop {
            block.clear();
            block.extend(rows.by_ref().take(BLOCK));
            if block.is_empty() {
                break;
            }
            this.rows += block.len();
            heads.push(this.words.len() as i32);
            for column in 0..columns {
                let [least, most] = range(block.iter().map(|row| row[column]));
                let (start, bits) = (this.words.len(), bits_of(least, most));
                heads.extend([least, bits as i32]);
                // Two words more for `put`, which the next column takes.
                this.words.resize(start + bits as usize + 2, 0);
                for (i, row) in block.iter().enumerate() {
                    let more = row[column].wrapping_sub(least) as u32;
                    put(&mut this.words, start * WORD + i * bits as usize, more);
                }
                this.words.truncate(start + bits as usize);
            }
        }
        this.words.extend([0; 2]);
        this.blocks = PackedRows::new(1 + 2 * columns, heads.chunks_exact(1 + 2 * columns));
        this
    }

    /// Packs a list, as a table of one column.
    pub(crate) fn list(numbers: &[i32]) -> Self {
        Self::new(1, numbers.chunks_exact(1))
    }

    /// Returns the number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Iterates over the numbers of a row, which must be there.
    #[inline]
    pub(crate) fn row(&self, row: usize) -> impl Iterator<Item = i32> + '_ {
        debug_assert!(row < self.rows, "row {row} of {}", self.rows);
        let (block, place) = (row / BLOCK, row % BLOCK);
        let mut word = self.blocks.get(block, 0) as u32 as usize;
        (0..self.columns).map(move |column| {
            let [least, bits] = [1, 2].map(|k| self.blocks.get(block, 2 * column + k));
            let more = number_at(&self.words, word * WORD + place * bits as usize, bits as u32);
            word += bits as usize;
            least.wrapping_add(more as i32)
        })
    }

    /// Returns a number of a list; `None` beyond its end.
    #[inline]
    pub(crate) fn at(&self, place: usize) -> Option<i32> {
        if place < self.rows { self.row(place).next() } else { None }
    }

    /// Returns the memory used, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.blocks.bytes() + size_of_val(&self.words[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_any_range_come_back() {
        let row = |i: i32| {
            let turned = i.wrapping_mul(0x3c6e_f372);
            let odd = if i == 40 { i32::MIN } else { i32::MAX };
            [i, turned, 7, i % 2 - 1, turned >> 13, odd, -1]
        };
        for count in [0, 1, 2, 63, 64, 65, 1000] {
            let numbers: Vec<[i32; 7]> = (0..count).map(row).collect();
            let table = PackedTable::new(7, numbers.iter().map(|row| &row[..]));
            assert_eq!(table.rows(), numbers.len());
            for (i, row) in numbers.iter().enumerate() {
                assert_eq!(table.row(i).collect::<Vec<_>>(), row, "row {i} of {count}");
            }
        }
    }

    #[test]
    fn a_column_takes_the_bits_of_its_range_in_a_block() {
        let words = |numbers: &[i32]| PackedTable::list(numbers).words.len() - 2;
        assert_eq!([words(&[]), words(&[5; 900]), words(&[-1, 0]), words(&[-9, 6])], [0, 0, 1, 4]);
        assert_eq!([words(&[0, 256]), words(&[i32::MIN, i32::MAX])], [9, 32]);
        let far: Vec<i32> = (0..128).map(|i| 1_000_000 * (i / 64) + i % 4).collect();
        assert_eq!(words(&far), 4, "two bits in each of two blocks");
        let all = PackedTable::list(&[3, 4]);
        assert_eq!([all.at(1), all.at(2), PackedTable::default().at(0)], [Some(4), None, None]);
    }

    #[test]
    fn rows_without_columns_are_counted() {
        let table = PackedTable::new(0, std::iter::repeat_n(&[][..], 70));
        assert_eq!((table.rows(), table.row(69).count()), (70, 0));
    }
}
