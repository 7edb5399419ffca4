//! Rows of integers, each in as many bits as the range of its column needs.

use super::bit_words::{WORD, bits_of, number_at, put, range};

/// Rows of 32-bit integers, one after another in a string of bits.
///
/// A number is the least one of its column and what it is more; a column of equal numbers takes no
/// bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PackedRows {
    columns: Vec<Column>,
    row_bits: usize,
    rows: usize,
    /// Bits, lowest first, padded so that every number lies within two existing words.
    words: Vec<u64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Column {
    least: i32,
    /// First bit in a row.
    start: u32,
    bits: u32,
}

impl PackedRows {
    /// Packs rows of `columns` numbers, in the given order.
    pub(crate) fn new<'n>(columns: usize, rows: impl Iterator<Item = &'n [i32]> + Clone) -> Self {
        let range = |column| range(rows.clone().map(|row| row[column]));
        let mut this = Self::of_ranges((0..columns).map(range));
        this.rows = rows.clone().count();
        this.words = vec![0; this.rows * this.row_bits / WORD + 2];
        let mut at = 0;
        for row in rows {
            for (column, &number) in this.columns.iter().zip(row) {
                let more = number.wrapping_sub(column.least) as u32;
                put(&mut this.words, at + column.start as usize, more);
            }
            at += this.row_bits;
        }
        this
    }

    /// Returns an empty table for columns from the least to the greatest of these numbers.
    fn of_ranges(ranges: impl Iterator<Item = [i32; 2]>) -> Self {
        let mut this = Self::default();
        for [least, most] in ranges {
            let bits = bits_of(least, most);
            this.columns.push(Column { least, start: this.row_bits as u32, bits });
            this.row_bits += bits as usize;
        }
        this
    }

    /// Returns the number in a column of a row; both must exist.
    #[inline]
    pub(crate) fn get(&self, row: usize, column: usize) -> i32 {
        debug_assert!(row < self.rows, "row {row} of {}", self.rows);
        let Column { least, start, bits } = self.columns[column];
        let number = number_at(&self.words, row * self.row_bits + start as usize, bits);
        least.wrapping_add(number as i32)
    }

    /// Returns the memory used, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.columns[..]) + size_of_val(&self.words[..])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_any_range_come_back() {
        let row = |i: i32| {
            let turned = i.wrapping_mul(0x3c6e_f372);
            [i, turned, 7, i % 2 - 1, turned >> 13, if i == 40 { i32::MIN } else { i32::MAX }]
        };
        for count in [0, 1, 2, 63, 64, 1000] {
            let numbers: Vec<[i32; 6]> = (0..count).map(row).collect();
            let table = PackedRows::new(6, numbers.iter().map(|row| &row[..]));
            for (i, row) in numbers.iter().enumerate() {
                let is: Vec<i32> = (0..6).map(|column| table.get(i, column)).collect();
                assert_eq!(is, row, "row {i} of {count}");
            }
        }
    }
}
