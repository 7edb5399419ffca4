//! How headers and numbers lie in the bits, and what a file has of them.

use glam::DVec3;

use super::frame::{ANGLE_BITS, Frame, NORMAL_BITS};
use super::shape::{Shape, Units, WIDEST, numbers};
use crate::bits::Bits;
use crate::bytes::{Malformed, Reader};
use crate::kd::BLOCK;

/// What all blocks have in common, and where each is.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Layout {
    /// How many vertices there are.
    pub(super) vertices: usize,
    /// The middle of the mesh.
    pub(super) centre: DVec3,
    pub(super) units: Units,
    /// What [`Group::middle`] counts.
    pub(super) reach: f64,
    /// Of widths, along the surface and across it, and of steps.
    pub(super) fields: [Field; 4],
    pub(super) groups: Vec<Group>,
}

/// Numbers of a header: the least, and how many bits those above it take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Field {
    pub(super) least: u8,
    pub(super) bits: u8,
}

/// Blocks whose anchors are told from one place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Group {
    /// Where its bits begin, in words of 32.
    pub(super) start: u32,
    /// That place, from the middle of the mesh on.
    pub(super) middle: [i8; 3],
    /// How many bits anchors have.
    pub(super) bits: [u8; 3],
}

/// So many blocks have a middle in common: fewer pay more for it, more are farther from it.
pub(super) const GROUP: usize = 32;
const WORD: usize = 32;
/// Vertices, words, the centre, the two units and the reach, the anchors' units, the fields.
const BYTES: usize = 2 * 4 + 3 * 8 + 2 * 8 + 2 + 4 * 2;
const GROUP_BYTES: usize = 4 + 3 + 3;
/// Beyond, sums and squares could be without end.
const FARTHEST: f64 = 1e60;

impl Field {
    /// That holds all of these, and none beyond 255.
    pub(super) fn of(numbers: impl Iterator<Item = u8> + Clone) -> Self {
        let least = numbers.clone().min().unwrap_or(0);
        let most = numbers.max().unwrap_or(0);
        let bits = u8::BITS - (most - least).leading_zeros();
        Self { least: least.min((256 - (1 << bits)) as u8), bits: bits as u8 }
    }

    fn is_sound(self) -> bool {
        u32::from(self.bits) <= u8::BITS && u32::from(self.least) + (1 << self.bits) <= 256
    }
}

impl Layout {
    pub(super) fn blocks(&self) -> usize {
        self.vertices.div_ceil(BLOCK)
    }

    /// What it takes, with so many bits.
    pub(super) fn bytes(&self, bits: &Bits) -> usize {
        BYTES + self.groups.len() * GROUP_BYTES + bits.len() / 8
    }

    /// Where a block's group has its middle.
    pub(super) fn middle(&self, block: usize) -> DVec3 {
        DVec3::from(self.groups[block / GROUP].middle.map(|x| f64::from(x) * self.reach))
    }

    /// The header of a block.
    pub(super) fn shape(&self, bits: &Bits, block: usize) -> Shape {
        let group = &self.groups[block / GROUP];
        let mut at = group.start as usize * WORD + block % GROUP * self.header(group);
        let mut next = |width: u32| {
            at += width as usize;
            bits.get(at - width as usize, width) as u32
        };
        let normal = [0; 2].map(|_| next(NORMAL_BITS));
        let frame = Frame { normal, angle: next(ANGLE_BITS) };
        let mut shape = Shape { frame, ..Shape::default() };
        for k in 0..3 {
            let [widths, steps] = self.fields_of(k);
            shape.widths[k] = widths.least + next(widths.bits.into()) as u8;
            shape.steps[k] = steps.least + next(steps.bits.into()) as u8;
            let width = u32::from(group.bits[k]);
            shape.anchors[k] = (i64::from(next(width)) - half(width)) as i32;
        }
        shape
    }

    /// Where the numbers of a block start: of the headers before it only those of its group are read.
    pub(super) fn start(&self, bits: &Bits, block: usize) -> usize {
        let first = block - block % GROUP;
        let group = &self.groups[block / GROUP];
        let headers = GROUP.min(self.blocks() - first) * self.header(group);
        // Only the last block of all has fewer vertices.
        let before = (first..block).map(|before| self.shape(bits, before).bits() as usize);
        group.start as usize * WORD + headers + before.sum::<usize>() * (BLOCK / 2)
    }

    /// Puts the next group behind the others: headers, then the cells of all vertices.
    pub(super) fn push(
        &mut self,
        bits: &mut Bits,
        middle: [i8; 3],
        shapes: &[Shape],
        cells: &[[i32; 3]],
    ) {
        let widths = [0, 1, 2].map(|k| signed_bits(shapes.iter().map(|shape| shape.anchors[k])));
        let start = (bits.len() / WORD) as u32;
        self.groups.push(Group { start, middle, bits: widths.map(|width| width as u8) });
        for shape in shapes {
            shape.frame.normal.iter().for_each(|&code| bits.push(code.into(), NORMAL_BITS));
            bits.push(shape.frame.angle.into(), ANGLE_BITS);
            for (k, &width) in widths.iter().enumerate() {
                let fields = self.fields_of(k);
                for (field, number) in fields.iter().zip([shape.widths[k], shape.steps[k]]) {
                    bits.push((number - field.least).into(), field.bits.into());
                }
                bits.push((i64::from(shape.anchors[k]) + half(width)) as u64, width);
            }
        }
        for (shape, cells) in shapes.iter().zip(cells.chunks(BLOCK)) {
            for pair in cells.chunks(2) {
                for (k, &width) in shape.widths.iter().enumerate() {
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
        self.fields.iter().for_each(|field| out.extend([field.least, field.bits]));
        for group in &self.groups {
            out.extend(group.start.to_le_bytes());
            out.extend(group.middle.map(|x| x as u8));
            out.extend(group.bits);
        }
        bits.store(out);
    }

    /// What [`Layout::store`] wrote, if nothing in it leads beyond its bits.
    pub(super) fn restore(reader: &mut Reader) -> Result<(Self, Bits), Malformed> {
        let vertices = reader.u32()? as usize;
        let words = reader.u32()? as usize;
        let mut length = |low: f64| {
            let x = reader.f64()?;
            let is_one = (low..FARTHEST).contains(&x);
            if is_one { Ok(x) } else { Err(reader.wrong(format!("{x} is no length that can be"))) }
        };
        let centre = DVec3::new(length(-FARTHEST)?, length(-FARTHEST)?, length(-FARTHEST)?);
        let (cell, reach) = (length(f64::MIN_POSITIVE)?, length(0.0)?);
        let units = Units { cell, anchors: [reader.u8()?, reader.u8()?] };
        let mut fields = [Field::default(); 4];
        for field in &mut fields {
            *field = Field { least: reader.u8()?, bits: reader.u8()? };
            if !field.is_sound() {
                return Err(reader.wrong("headers have numbers beyond 255"));
            }
        }
        let mut this = Self { vertices, centre, units, reach, fields, groups: Vec::new() };
        for _ in 0..this.blocks().div_ceil(GROUP) {
            // As many as there are bytes for, whatever the number of vertices.
            let start = reader.u32()?;
            let mut next = || reader.u8();
            let middle = [next()? as i8, next()? as i8, next()? as i8];
            this.groups.push(Group { start, middle, bits: [next()?, next()?, next()?] });
        }
        let bits = Bits::restore(words * WORD, reader)?;
        this.check(&bits).map_err(|reason| reader.wrong(reason))?;
        Ok((this, bits))
    }

    /// That groups follow each other to the end.
    fn check(&self, bits: &Bits) -> Result<(), String> {
        let mut end = 0;
        for (number, group) in self.groups.iter().enumerate() {
            if group.start as usize * WORD != end || group.bits.iter().any(|&width| width > 31) {
                return Err(format!("group {number} should start at word {}", end / WORD));
            }
            let first = number * GROUP;
            let last = (first + GROUP).min(self.blocks());
            end += (last - first) * self.header(group);
            for block in first..last {
                if end > bits.len() {
                    return Err(format!("the headers of group {number} are beyond the end"));
                }
                let count = BLOCK.min(self.vertices - block * BLOCK);
                let shape = self.shape(bits, block);
                if shape.widths.iter().any(|&width| width > WIDEST) {
                    return Err(format!("block {block} has a width beyond {WIDEST}"));
                }
                end += shape.bits() as usize * count.div_ceil(2);
            }
            end = end.next_multiple_of(WORD);
        }
        if end == bits.len() { Ok(()) } else { Err(format!("{end} bits, not {}", bits.len())) }
    }

    /// How many bits each header of a group has.
    fn header(&self, group: &Group) -> usize {
        let fields = [0, 0, 1, 2, 2, 3].iter().map(|&f| u32::from(self.fields[f].bits));
        let anchors = group.bits.iter().map(|&width| u32::from(width));
        (2 * NORMAL_BITS + ANGLE_BITS + fields.chain(anchors).sum::<u32>()) as usize
    }

    /// Of widths and of steps along an axis.
    fn fields_of(&self, axis: usize) -> [Field; 2] {
        let across = usize::from(axis == 2);
        [self.fields[across], self.fields[2 + across]]
    }
}

/// What is put to signed numbers of so many bits.
fn half(bits: u32) -> i64 {
    if bits == 0 { 0 } else { 1 << (bits - 1) }
}

/// How many bits hold all of them, with their signs.
fn signed_bits(mut numbers: impl Iterator<Item = i32> + Clone) -> u32 {
    if numbers.clone().all(|x| x == 0) {
        return 0;
    }
    let magnitude = |bits: u32, x: i32| bits.max(u32::BITS - (x ^ (x >> 31)).leading_zeros());
    1 + numbers.by_ref().fold(0, magnitude)
}
