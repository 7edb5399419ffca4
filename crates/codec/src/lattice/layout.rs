//! Bit layout of block headers and cell numbers, in memory and in files.

use rayon::prelude::*;

use super::search::{BEND_BITS, COARSE, COARSE_BITS, SLOPE_BITS, axes};
use super::shear::{MAX_CELLS, ShearTransform};
use crate::bits::Bits;
use crate::bytes::{Malformed, Reader};
use crate::header_field::HeaderField;
use crate::kd::BLOCK;

/// Blocks on the lattice, in cells relative to the mesh's least one.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct LatticeLayout {
    pub(super) vertices: usize,
    /// Greatest cell along each axis.
    pub(super) most: [i32; 3],
    /// Start of each group's bits, in 32-bit words.
    starts: Vec<u32>,
    bits: Bits,
}

/// Header of a group of blocks.
#[derive(Clone, Copy, Debug)]
struct GroupHeader {
    /// Start of the block headers.
    at: usize,
    /// Lowest middle along each axis, and the bits of the offsets above it.
    first: [i32; 3],
    bits: [u32; 3],
    /// Span codes along blocks and across them.
    spans: [HeaderField; 2],
    is_bent: bool,
}

/// Blocks per group.
const GROUP: usize = 32;
const WORD: usize = 32;
/// Bits of the size of a middle, of the least span code, and of the size of codes above it.
const MIDDLE_BITS: u32 = 5;
const CODE_BITS: u32 = 8;
const ABOVE_BITS: u32 = 4;
/// Bits of a group header without its first middle.
const GROUP_BITS: u32 = 1 + 3 * MIDDLE_BITS + 2 * (CODE_BITS + ABOVE_BITS);
const AXIS_BITS: u32 = 2;
/// Code of a zero slope or bend.
const SLOPE_ZERO: i32 = 1 << (SLOPE_BITS - 1);
const COARSE_ZERO: i32 = 1 << (COARSE_BITS - 1);
const BEND_ZERO: i32 = 1 << (BEND_BITS - 1);
/// Size of vertices, words and the greatest cells.
const BYTES: usize = 2 * 4 + 3 * 4;

impl LatticeLayout {
    /// Packs cells, with bent or plain blocks in each group, whichever take fewer bits.
    pub(super) fn new(cells: &[[i32; 3]], most: [i32; 3]) -> Self {
        let transforms = |is_bent: bool| -> Vec<ShearTransform> {
            cells.par_chunks(BLOCK).map(|block| ShearTransform::of(block, is_bent)).collect()
        };
        let (plain, bent) = (transforms(false), transforms(true));
        let mut this = Self { vertices: cells.len(), most, ..Self::default() };
        let pairs = plain.chunks(GROUP).zip(bent.chunks(GROUP));
        for ((plain, bent), cells) in pairs.zip(cells.chunks(BLOCK * GROUP)) {
            let bits = |transforms: &[ShearTransform], is_bent: bool| {
                let numbers = transforms.iter().zip(cells.chunks(BLOCK));
                let numbers = numbers.map(|(transform, cells)| transform.bits(cells.len()));
                let headers =
                    transforms.len() * Self::header_bits(&Self::group_of(transforms, is_bent));
                numbers.sum::<usize>() + headers
            };
            let is_bent = bits(bent, true) < bits(plain, false);
            this.push(if is_bent { bent } else { plain }, is_bent, cells);
        }
        this
    }

    pub(super) fn bytes(&self) -> usize {
        BYTES + 4 * self.starts.len() + self.bits.len() / 8
    }

    pub(super) fn blocks(&self) -> usize {
        self.vertices.div_ceil(BLOCK)
    }

    /// Decodes the cell of a vertex.
    pub(super) fn cell(&self, at: usize) -> [i64; 3] {
        let (transform, start) = self.block(at / BLOCK);
        self.cell_in(&transform, start, at % BLOCK)
    }

    /// Decodes all cells.
    pub(super) fn cells(&self) -> impl Iterator<Item = [i64; 3]> {
        (0..self.blocks()).flat_map(move |block| {
            let (transform, start) = self.block(block);
            let count = BLOCK.min(self.vertices - block * BLOCK);
            (0..count).map(move |at| self.cell_in(&transform, start, at))
        })
    }

    fn cell_in(&self, transform: &ShearTransform, start: usize, at: usize) -> [i64; 3] {
        let (size, bits) = transform.tuple();
        let start = start + at / size * bits as usize;
        let low = bits.min(u64::BITS);
        let number = u128::from(self.bits.get(start, low))
            | u128::from(self.bits.get(start + low as usize, bits - low)) << low;
        transform.cell(number, at % size)
    }

    /// Returns a block's transform and where its numbers start. Of the headers before it, only
    /// those of its group are read.
    fn block(&self, block: usize) -> (ShearTransform, usize) {
        let group = self.group(block / GROUP);
        let first = block - block % GROUP;
        let headers = GROUP.min(self.blocks() - first) * Self::header_bits(&group);
        // All blocks but the last one have the full number of vertices.
        let before = (0..block % GROUP).map(|before| self.transform(&group, before).bits(BLOCK));
        (self.transform(&group, block % GROUP), group.at + headers + before.sum::<usize>())
    }

    /// Returns the transform of each block, and the bit at which its numbers start.
    pub(super) fn transforms(&self) -> Vec<(ShearTransform, usize)> {
        let mut blocks = Vec::with_capacity(self.blocks());
        for (number, first) in (0..self.blocks()).step_by(GROUP).enumerate() {
            let group = self.group(number);
            let count = GROUP.min(self.blocks() - first);
            let mut start = group.at + count * Self::header_bits(&group);
            for block in 0..count {
                let transform = self.transform(&group, block);
                blocks.push((transform, start));
                start += transform.bits(BLOCK);
            }
        }
        blocks
    }

    pub(super) fn words(&self) -> &[u64] {
        self.bits.words()
    }

    fn group(&self, number: usize) -> GroupHeader {
        let mut at = self.starts[number] as usize * WORD;
        let mut next = |width: u32| {
            at += width as usize;
            self.bits.get(at - width as usize, width) as u32
        };
        let is_bent = next(1) == 1;
        let first = self.widths().map(|width| next(width) as i32);
        let bits = first.map(|_| next(MIDDLE_BITS));
        let spans =
            [0; 2].map(|_| HeaderField { least: next(CODE_BITS) as u8, bits: next(ABOVE_BITS) });
        GroupHeader { at, first, bits, spans, is_bent }
    }

    /// Builds the group header for blocks, without its place in the bits.
    fn group_of(transforms: &[ShearTransform], is_bent: bool) -> GroupHeader {
        let (mut first, mut last) = ([i32::MAX; 3], [0; 3]);
        for transform in transforms {
            for (k, axis) in axes(transform.axis).into_iter().enumerate() {
                first[axis] = first[axis].min(transform.middle[k]);
                last[axis] = last[axis].max(transform.middle[k]);
            }
        }
        let bits = [0, 1, 2].map(|axis| u32::BITS - (last[axis] - first[axis]).leading_zeros());
        let along =
            transforms.iter().flat_map(|transform| [transform.spans[0], transform.spans[1]]);
        let across = transforms.iter().map(|transform| transform.spans[2]);
        GroupHeader {
            at: 0,
            first,
            bits,
            spans: [HeaderField::covering(along), HeaderField::covering(across)],
            is_bent,
        }
    }

    /// Returns the number of bits of each block header in a group.
    fn header_bits(group: &GroupHeader) -> usize {
        let [along, across] = group.spans.map(|field| field.bits);
        let bends = if group.is_bent { 3 * BEND_BITS } else { 0 };
        let middle: u32 = group.bits.iter().sum();
        (AXIS_BITS + 2 * (COARSE_BITS + SLOPE_BITS) + bends + 2 * along + across + middle) as usize
    }

    fn transform(&self, group: &GroupHeader, number: usize) -> ShearTransform {
        let mut at = group.at + number * Self::header_bits(group);
        let mut next = |width: u32| {
            at += width as usize;
            self.bits.get(at - width as usize, width) as i32
        };
        let mut transform =
            ShearTransform { axis: next(AXIS_BITS) as u8, ..ShearTransform::default() };
        let [s, r] = [0; 2].map(|_| (next(COARSE_BITS) - COARSE_ZERO) as i8 * COARSE);
        let [a, b] = [0; 2].map(|_| (next(SLOPE_BITS) - SLOPE_ZERO) as i8);
        transform.slopes = [s, r, a, b];
        if group.is_bent {
            transform.bends = [0; 3].map(|_| (next(BEND_BITS) - BEND_ZERO) as i8);
        }
        for (k, axis) in axes(transform.axis).into_iter().enumerate() {
            let field = group.spans[k / 2];
            transform.spans[k] = field.least + next(field.bits) as u8;
            transform.middle[k] = group.first[axis] + next(group.bits[axis]);
        }
        transform
    }

    /// Returns the number of bits of a group's first middle along each axis.
    fn widths(&self) -> [u32; 3] {
        self.most.map(|most| u32::BITS - most.leading_zeros())
    }

    /// Appends a group.
    fn push(&mut self, transforms: &[ShearTransform], is_bent: bool, cells: &[[i32; 3]]) {
        self.starts.push((self.bits.len() / WORD) as u32);
        let group = Self::group_of(transforms, is_bent);
        self.bits.push(is_bent.into(), 1);
        for (first, width) in group.first.into_iter().zip(self.widths()) {
            self.bits.push(first as u64, width);
        }
        group.bits.iter().for_each(|&bits| self.bits.push(bits.into(), MIDDLE_BITS));
        for field in group.spans {
            self.bits.push(field.least.into(), CODE_BITS);
            self.bits.push(field.bits.into(), ABOVE_BITS);
        }
        transforms.iter().for_each(|transform| self.push_header(transform, &group));
        for (transform, cells) in transforms.iter().zip(cells.chunks(BLOCK)) {
            let (size, bits) = transform.tuple();
            for tuple in cells.chunks(size) {
                let (number, low) = (transform.number(tuple), bits.min(u64::BITS));
                self.bits.push(number as u64 & u64::MAX >> (u64::BITS - low).min(63), low);
                self.bits.push((number >> low) as u64, bits - low);
            }
        }
        let end = self.bits.len();
        self.bits.push(0, (end.next_multiple_of(WORD) - end) as u32);
    }

    fn push_header(&mut self, transform: &ShearTransform, group: &GroupHeader) {
        let bits = &mut self.bits;
        bits.push(transform.axis.into(), AXIS_BITS);
        let [s, r, a, b] = transform.slopes.map(i32::from);
        for x in [s, r] {
            bits.push((x / i32::from(COARSE) + COARSE_ZERO) as u64, COARSE_BITS);
        }
        for x in [a, b] {
            bits.push((x + SLOPE_ZERO) as u64, SLOPE_BITS);
        }
        if group.is_bent {
            transform
                .bends
                .iter()
                .for_each(|&x| bits.push((i32::from(x) + BEND_ZERO) as u64, BEND_BITS));
        }
        for (k, axis) in axes(transform.axis).into_iter().enumerate() {
            let field = group.spans[k / 2];
            bits.push((transform.spans[k] - field.least).into(), field.bits);
            bits.push((transform.middle[k] - group.first[axis]) as u64, group.bits[axis]);
        }
    }

    pub(super) fn store(&self, out: &mut Vec<u8>) {
        out.extend((self.vertices as u32).to_le_bytes());
        out.extend(((self.bits.len() / WORD) as u32).to_le_bytes());
        self.most.iter().for_each(|most| out.extend(most.to_le_bytes()));
        self.starts.iter().for_each(|start| out.extend(start.to_le_bytes()));
        self.bits.store(out);
    }

    /// Reads what [`LatticeLayout::store`] wrote, and checks that nothing in it leads beyond its
    /// bits.
    pub(super) fn restore(reader: &mut Reader) -> Result<Self, Malformed> {
        let vertices = reader.u32()? as usize;
        let words = reader.u32()? as usize;
        let most = [reader.i32()?, reader.i32()?, reader.i32()?];
        if !most.iter().all(|most| (0..MAX_CELLS).contains(most)) {
            return Err(reader.wrong(format!("the greatest cells {most:?} are out of range")));
        }
        let groups = vertices.div_ceil(BLOCK).div_ceil(GROUP);
        let starts = reader.take(4 * groups)?.chunks_exact(4);
        let start = |bytes: &[u8]| bytes.iter().rev().fold(0, |x, &byte| x << 8 | u32::from(byte));
        let starts = starts.map(start).collect();
        let bits = Bits::restore(words * WORD, reader)?;
        let this = Self { vertices, most, starts, bits };
        this.check().map_err(|reason| reader.wrong(reason))?;
        Ok(this)
    }

    /// Checks that the groups follow each other up to the end.
    fn check(&self) -> Result<(), String> {
        let mut end = 0;
        for (number, &start) in self.starts.iter().enumerate() {
            let first = number * GROUP;
            let last = (first + GROUP).min(self.blocks());
            let widths: u32 = self.widths().iter().sum();
            let is_there = |end: usize| {
                let beyond = || format!("group {number} ends at bit {end}, beyond the data");
                if end <= self.bits.len() { Ok(()) } else { Err(beyond()) }
            };
            is_there(end + (widths + GROUP_BITS) as usize)?;
            if start as usize * WORD != end {
                return Err(format!("group {number} does not start at word {}", end / WORD));
            }
            let group = self.group(number);
            if group.bits.iter().any(|&bits| bits >= 20) {
                return Err(format!("group {number} has middles of more than 19 bits"));
            }
            if !group.spans.iter().all(|field| field.is_valid()) {
                return Err(format!("group {number} has span codes above 255"));
            }
            end = group.at + (last - first) * Self::header_bits(&group);
            is_there(end)?;
            for block in first..last {
                let count = BLOCK.min(self.vertices - block * BLOCK);
                end += self.transform(&group, block - first).bits(count);
            }
            end = end.next_multiple_of(WORD);
        }
        if end == self.bits.len() {
            Ok(())
        } else {
            Err(format!("expected {end} bits, found {}", self.bits.len()))
        }
    }
}
