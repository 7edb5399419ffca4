//! Bit layout of block headers and cell numbers, in memory and in files.

use glam::DVec3;

use super::frame::{ANGLE_BITS, Frame, NORMAL_BITS};
use super::header::{BlockHeader, Units, WIDEST, numbers};
use crate::bits::Bits;
use crate::bytes::{Malformed, Reader};
use crate::header_field::HeaderField;
use crate::kd::BLOCK;

/// Parameters that all blocks share, and the place of each group of blocks.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BlockLayout {
    /// Number of vertices.
    pub(super) vertices: usize,
    /// Centre of the mesh.
    pub(super) centre: DVec3,
    pub(super) units: Units,
    /// Unit of [`BlockGroup::middle`], in model units.
    pub(super) reach: f64,
    /// Widths along the surface and across it, then steps along and across.
    pub(super) fields: [HeaderField; 4],
    pub(super) groups: Vec<BlockGroup>,
}

/// Group of blocks whose anchors are relative to one point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct BlockGroup {
    /// Start of its bits, in 32-bit words.
    pub(super) start: u32,
    /// Origin of the anchors, relative to the centre of the mesh.
    pub(super) middle: [i8; 3],
    /// Bits of an anchor along each axis.
    pub(super) bits: [u8; 3],
}

/// Blocks per group. Smaller groups pay more for their headers; in larger ones blocks are farther
/// from the middle.
pub(super) const GROUP: usize = 32;
const WORD: usize = 32;
/// Size of vertices, words, the centre, two units, the anchors' units and the fields.
const BYTES: usize = 2 * 4 + 3 * 8 + 2 * 8 + 2 + 4 * 2;
const GROUP_BYTES: usize = 4 + 3 + 3;
/// Limit on lengths in a file, so that sums and squares stay finite.
const MAX_LENGTH: f64 = 1e60;

impl BlockLayout {
    pub(super) fn blocks(&self) -> usize {
        self.vertices.div_ceil(BLOCK)
    }

    /// Returns the stored size in bytes.
    pub(super) fn bytes(&self, bits: &Bits) -> usize {
        BYTES + self.groups.len() * GROUP_BYTES + bits.len() / 8
    }

    /// Returns the middle of a block's group.
    pub(super) fn middle(&self, block: usize) -> DVec3 {
        DVec3::from(self.groups[block / GROUP].middle.map(|x| f64::from(x) * self.reach))
    }

    /// Decodes the header of a block.
    pub(super) fn header(&self, bits: &Bits, block: usize) -> BlockHeader {
        let group = &self.groups[block / GROUP];
        let mut at = group.start as usize * WORD + block % GROUP * self.header_bits(group);
        let mut next = |width: u32| {
            at += width as usize;
            bits.get(at - width as usize, width) as u32
        };
        let normal = [0; 2].map(|_| next(NORMAL_BITS));
        let frame = Frame { normal, angle: next(ANGLE_BITS) };
        let mut header = BlockHeader { frame, ..BlockHeader::default() };
        for k in 0..3 {
            let [widths, steps] = self.fields_of(k);
            header.widths[k] = widths.least + next(widths.bits) as u8;
            header.steps[k] = steps.least + next(steps.bits) as u8;
            let width = u32::from(group.bits[k]);
            header.anchors[k] = (i64::from(next(width)) - half(width)) as i32;
        }
        header
    }

    /// Returns where the numbers of a block start. Of the headers before it, only those of its
    /// group are read.
    pub(super) fn start(&self, bits: &Bits, block: usize) -> usize {
        let first = block - block % GROUP;
        let group = &self.groups[block / GROUP];
        let headers = GROUP.min(self.blocks() - first) * self.header_bits(group);
        // All blocks but the last one have the full number of vertices.
        let before = (first..block).map(|before| self.header(bits, before).bits() as usize);
        group.start as usize * WORD + headers + before.sum::<usize>() * (BLOCK / 2)
    }

    /// Appends a group: its headers, then the cells of all its vertices.
    pub(super) fn push(
        &mut self,
        bits: &mut Bits,
        middle: [i8; 3],
        headers: &[BlockHeader],
        cells: &[[i32; 3]],
    ) {
        let widths = [0, 1, 2].map(|k| signed_bits(headers.iter().map(|header| header.anchors[k])));
        let start = (bits.len() / WORD) as u32;
        self.groups.push(BlockGroup { start, middle, bits: widths.map(|width| width as u8) });
        for header in headers {
            header.frame.normal.iter().for_each(|&code| bits.push(code.into(), NORMAL_BITS));
            bits.push(header.frame.angle.into(), ANGLE_BITS);
            for (k, &width) in widths.iter().enumerate() {
                let fields = self.fields_of(k);
                for (field, number) in fields.iter().zip([header.widths[k], header.steps[k]]) {
                    bits.push((number - field.least).into(), field.bits);
                }
                bits.push((i64::from(header.anchors[k]) + half(width)) as u64, width);
            }
        }
        for (header, cells) in headers.iter().zip(cells.chunks(BLOCK)) {
            for pair in cells.chunks(2) {
                for (k, &width) in header.widths.iter().enumerate() {
                    let second = pair.get(1).map_or(0, |cell| cell[k] as u64);
                    bits.push(pair[0][k] as u64 + second * numbers(width), width.into());
                }
            }
        }
        bits.push(0, (bits.len().next_multiple_of(WORD) - bits.len()) as u32);
    }

    pub(super) fn store(&self, bits: &Bits, out: &mut Vec<u8>) {
        out.extend((self.vertices as u32).to_le_bytes());
        out.extend(((bits.len() / WORD) as u32).to_le_bytes());
        let lengths = self.centre.to_array().into_iter().chain([self.units.cell, self.reach]);
        lengths.for_each(|x| out.extend(x.to_le_bytes()));
        out.extend(self.units.anchors);
        self.fields.iter().for_each(|field| out.extend([field.least, field.bits as u8]));
        for group in &self.groups {
            out.extend(group.start.to_le_bytes());
            out.extend(group.middle.map(|x| x as u8));
            out.extend(group.bits);
        }
        bits.store(out);
    }

    /// Reads what [`BlockLayout::store`] wrote, and checks that nothing in it leads beyond its
    /// bits.
    pub(super) fn restore(reader: &mut Reader) -> Result<(Self, Bits), Malformed> {
        let vertices = reader.u32()? as usize;
        let words = reader.u32()? as usize;
        let mut length = |low: f64| {
            let x = reader.f64()?;
            let is_valid = (low..MAX_LENGTH).contains(&x);
            if is_valid {
                Ok(x)
            } else {
                Err(reader.wrong(format!("{x} is out of range for a length")))
            }
        };
        let centre = DVec3::new(length(-MAX_LENGTH)?, length(-MAX_LENGTH)?, length(-MAX_LENGTH)?);
        let (cell, reach) = (length(f64::MIN_POSITIVE)?, length(0.0)?);
        let units = Units { cell, anchors: [reader.u8()?, reader.u8()?] };
        let mut fields = [HeaderField::default(); 4];
        for field in &mut fields {
            *field = HeaderField { least: reader.u8()?, bits: reader.u8()?.into() };
            if !field.is_valid() {
                return Err(reader.wrong("a header field has numbers above 255"));
            }
        }
        let mut this = Self { vertices, centre, units, reach, fields, groups: Vec::new() };
        for _ in 0..this.blocks().div_ceil(GROUP) {
            // Grows with the bytes read, whatever the number of vertices claims.
            let start = reader.u32()?;
            let mut next = || reader.u8();
            let middle = [next()? as i8, next()? as i8, next()? as i8];
            this.groups.push(BlockGroup { start, middle, bits: [next()?, next()?, next()?] });
        }
        let bits = Bits::restore(words * WORD, reader)?;
        this.check(&bits).map_err(|reason| reader.wrong(reason))?;
        Ok((this, bits))
    }

    /// Checks that the groups follow each other up to the end.
    fn check(&self, bits: &Bits) -> Result<(), String> {
        let mut end = 0;
        for (number, group) in self.groups.iter().enumerate() {
            if group.start as usize * WORD != end || group.bits.iter().any(|&width| width > 31) {
                return Err(format!("group {number} does not start at word {}", end / WORD));
            }
            let first = number * GROUP;
            let last = (first + GROUP).min(self.blocks());
            end += (last - first) * self.header_bits(group);
            for block in first..last {
                if end > bits.len() {
                    return Err(format!("the headers of group {number} end beyond the data"));
                }
                let count = BLOCK.min(self.vertices - block * BLOCK);
                let header = self.header(bits, block);
                if header.widths.iter().any(|&width| width > WIDEST) {
                    return Err(format!("block {block} has a width above {WIDEST}"));
                }
                end += header.bits() as usize * count.div_ceil(2);
            }
            end = end.next_multiple_of(WORD);
        }
        if end == bits.len() {
            Ok(())
        } else {
            Err(format!("expected {end} bits, found {}", bits.len()))
        }
    }

    /// Returns the number of bits of each header in a group.
    fn header_bits(&self, group: &BlockGroup) -> usize {
        let fields = [0, 0, 1, 2, 2, 3].iter().map(|&f| self.fields[f].bits);
        let anchors = group.bits.iter().map(|&width| u32::from(width));
        (2 * NORMAL_BITS + ANGLE_BITS + fields.chain(anchors).sum::<u32>()) as usize
    }

    /// Returns the fields of the width and the step along an axis.
    fn fields_of(&self, axis: usize) -> [HeaderField; 2] {
        let across = usize::from(axis == 2);
        [self.fields[across], self.fields[2 + across]]
    }
}

/// Returns the offset that makes signed numbers of this many bits unsigned.
fn half(bits: u32) -> i64 {
    if bits == 0 { 0 } else { 1 << (bits - 1) }
}

/// Returns the number of bits that hold all these signed numbers.
fn signed_bits(mut numbers: impl Iterator<Item = i32> + Clone) -> u32 {
    if numbers.clone().all(|x| x == 0) {
        return 0;
    }
    let magnitude = |bits: u32, x: i32| bits.max(u32::BITS - (x ^ (x >> 31)).leading_zeros());
    1 + numbers.by_ref().fold(0, magnitude)
}
