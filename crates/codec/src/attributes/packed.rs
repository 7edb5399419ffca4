//! Packed integers of nodes, row by row: each row has its own minimum and number of bits.

use crate::bits::{Bits, width};
use crate::bytes::{Malformed, Reader};
use crate::patch::Rows;

/// Packed integers, a fixed number of components for each node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct PackedRows {
    /// Nodes of each row.
    rows: Rows,
    /// Bits of a row's minimum, for each component.
    widths: Vec<u32>,
    /// Minimum of each row and component, and the bits of the offsets from it.
    heads: Bits,
    numbers: Bits,
    /// Bit at which the numbers of every [`STRIDE`]-th row start.
    starts: Vec<u64>,
}

/// Rows per stored start.
const STRIDE: usize = 16;
/// Bits of a width, which is at most 32.
const WIDTH_BITS: u32 = 6;

impl PackedRows {
    /// Packs integers, `components` for each node, in the order of the rows.
    pub(crate) fn new(rows: Rows, components: usize, numbers: &[u32]) -> Self {
        let most = |k: usize| numbers.iter().skip(k).step_by(components).max().copied();
        let widths = (0..components).map(|k| width(most(k).map_or(0, |most| most as usize + 1)));
        let mut this = Self {
            rows,
            widths: widths.collect(),
            heads: Bits::default(),
            numbers: Bits::default(),
            starts: Vec::new(),
        };
        for row in 0..this.rows.len() {
            if row % STRIDE == 0 {
                this.starts.push(this.numbers.len() as u64);
            }
            let nodes = this.rows.range(row);
            this.push(&numbers[components * nodes.start..components * nodes.end]);
        }
        this
    }

    fn push(&mut self, numbers: &[u32]) {
        let components = self.widths.len();
        let of = |k: usize| numbers.iter().skip(k).step_by(components).copied();
        let spans: Vec<_> = (0..components)
            .map(|k| {
                let least = of(k).min().unwrap_or(0);
                (least, width((of(k).max().unwrap_or(0) - least) as usize + 1))
            })
            .collect();
        for (&(least, width), &least_width) in spans.iter().zip(&self.widths) {
            self.heads.push(least.into(), least_width);
            self.heads.push(width.into(), WIDTH_BITS);
        }
        for node in numbers.chunks_exact(components) {
            for (&number, &(least, width)) in node.iter().zip(&spans) {
                self.numbers.push((number - least).into(), width);
            }
        }
    }

    pub(crate) fn rows(&self) -> &Rows {
        &self.rows
    }

    /// Returns the number of integers per node.
    pub(crate) fn components(&self) -> usize {
        self.widths.len()
    }

    /// Decodes the integers of one node, given by its row and its number there.
    pub(crate) fn get(&self, row: usize, number: usize) -> Vec<u32> {
        let stride = row - row % STRIDE;
        let before = (stride..row).map(|row| self.rows.range(row).len() * self.row_bits(row));
        let start = self.starts[row / STRIDE] as usize + before.sum::<usize>();
        let mut numbers = Vec::with_capacity(self.components());
        self.read(row, start + number * self.row_bits(row), &mut numbers);
        numbers
    }

    /// Decodes the integers of all nodes of a row.
    pub(crate) fn row(&self, row: usize) -> Vec<u32> {
        let count = self.rows.range(row).len();
        (0..count).flat_map(|number| self.get(row, number)).collect()
    }

    /// Decodes all integers.
    pub(crate) fn all(&self) -> Vec<u32> {
        let mut numbers = Vec::with_capacity(self.components() * self.rows.nodes());
        let mut at = 0;
        for row in 0..self.rows.len() {
            for _ in self.rows.range(row) {
                at = self.read(row, at, &mut numbers);
            }
        }
        numbers
    }

    /// Decodes a node's integers from a bit on, and returns where they end.
    fn read(&self, row: usize, mut at: usize, numbers: &mut Vec<u32>) -> usize {
        for (least, width) in self.spans(row) {
            numbers.push(least.wrapping_add(self.numbers.get(at, width) as u32));
            at += width as usize;
        }
        at
    }

    /// Returns for each component of a row its minimum, and the bits of the offsets.
    fn spans(&self, row: usize) -> impl Iterator<Item = (u32, u32)> {
        let mut at = row * self.head_bits();
        let mut next = move |width: u32| {
            at += width as usize;
            self.heads.get(at - width as usize, width) as u32
        };
        self.widths.iter().map(move |&width| (next(width), next(WIDTH_BITS)))
    }

    fn head_bits(&self) -> usize {
        self.widths.iter().map(|width| (width + WIDTH_BITS) as usize).sum()
    }

    fn row_bits(&self, row: usize) -> usize {
        self.spans(row).map(|(_, width)| width as usize).sum()
    }

    /// Returns the size in bytes, with everything needed to decode them.
    pub(crate) fn bytes(&self) -> usize {
        let bits = self.heads.len().div_ceil(8) + self.numbers.len().div_ceil(8);
        self.widths.len() + size_of_val(&self.starts[..]) + bits
    }

    /// Appends everything but the rows and the number of components.
    pub(crate) fn store(&self, out: &mut Vec<u8>) {
        out.extend(self.widths.iter().map(|&width| width as u8));
        self.heads.store(out);
        out.extend(self.starts.iter().flat_map(|start| start.to_le_bytes()));
        self.numbers.store(out);
    }

    pub(crate) fn restore(
        rows: Rows,
        components: usize,
        reader: &mut Reader,
    ) -> Result<Self, Malformed> {
        let widths: Vec<u32> = reader.take(components)?.iter().map(|&width| width.into()).collect();
        if widths.iter().any(|&width| width > u32::BITS) {
            return Err(reader.wrong("a row has a minimum of more than 32 bits"));
        }
        let (heads, numbers, starts) = (Bits::default(), Bits::default(), Vec::new());
        let mut this = Self { rows, widths, heads, numbers, starts };
        this.heads = Bits::restore(this.rows.len() * this.head_bits(), reader)?;
        let mut end = 0;
        for row in 0..this.rows.len() {
            if this.spans(row).any(|(_, width)| width > u32::BITS) {
                return Err(reader.wrong(format!("row {row} has numbers of more than 32 bits")));
            }
            if row % STRIDE == 0 {
                this.starts.push(end as u64);
                if reader.u64()? != end as u64 {
                    return Err(reader.wrong(format!("row {row} has a wrong start")));
                }
            }
            end += this.rows.range(row).len() * this.row_bits(row);
        }
        this.numbers = Bits::restore(end, reader)?;
        Ok(this)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packed() -> (Vec<u32>, PackedRows) {
        let sizes = (0..40).map(|row| row * 7 % 5);
        let rows = Rows::new(sizes);
        let number = |at: u32| at.wrapping_mul(0x9e37_79b9) >> (at / 3 % 33).min(31);
        let numbers: Vec<u32> = (0..3 * rows.nodes() as u32).map(number).collect();
        (numbers.clone(), PackedRows::new(rows, 3, &numbers))
    }

    #[test]
    fn numbers_decode_together_and_alone() {
        let (numbers, packed) = packed();
        assert_eq!(packed.all(), numbers);
        let mut all = numbers.chunks(3);
        for row in 0..packed.rows.len() {
            for number in 0..packed.rows.range(row).len() {
                assert_eq!(packed.get(row, number), all.next().unwrap());
            }
        }
    }

    #[test]
    fn sizes_are_as_reported_and_damaged_bytes_do_no_harm() {
        let (_, packed) = packed();
        let mut bytes = Vec::new();
        packed.store(&mut bytes);
        assert_eq!(bytes.len(), packed.bytes());
        let restore =
            |bytes: &[u8]| PackedRows::restore(packed.rows.clone(), 3, &mut Reader::new(bytes));
        assert_eq!(restore(&bytes), Ok(packed.clone()));
        assert!(restore(&bytes[..bytes.len() - 1]).is_err());
        for bit in 0..8 * bytes.len() {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            if let Ok(packed) = restore(&damaged) {
                assert_eq!(packed.all().len(), 3 * packed.rows.nodes());
            }
        }
    }

    #[test]
    fn equal_values_in_a_row_take_no_bits() {
        let same = PackedRows::new(Rows::new([1000]), 1, &[u32::MAX; 1000]);
        assert!(same.bytes() < 20);
        assert_eq!(same.get(0, 999), [u32::MAX]);
    }
}
