//! Pairs of boxes that overlap: blocks of eight, in an order along a curve, one level over the other.

use std::ops::ControlFlow;

use glam::{DVec3, Vec3, Vec4};

use crate::box3::Box3;
use crate::curve::{self, Middle};

/// Boxes a block holds, and children a node has.
pub const LANES: usize = 8;

/// Boxes in an order in which near ones follow each other, in blocks of eight, and blocks of blocks.
///
/// Answers one question: which boxes overlap? Building is a sort and one pass, so that asking once
/// pays. Size: 27 bytes a box.
#[derive(Clone, Debug)]
pub struct BoxBlocks {
    /// The item of each place in the order; whole blocks, the last filled with `u32::MAX`.
    items: Vec<u32>,
    /// The blocks of items, then the blocks of these blocks, and so on; one on top.
    levels: Vec<Vec<Block>>,
    /// The group of each block of each level, [`MIXED`] for several; no levels where all are alone.
    groups: Vec<Vec<u32>>,
}

/// The group of what is in no group, or in several.
const MIXED: u32 = u32::MAX;

/// Eight boxes, axis by axis, one lane a box. A lane without a box overlaps nothing.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Block {
    lo: [Lanes; 3],
    hi: [Lanes; 3],
}

/// Four lanes twice: what one instruction compares.
type Lanes = [[f32; LANES / 2]; 2];

/// Boxes of one block that overlap one box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// The place of the one box in the order.
    pub one: u32,
    /// The block: places `8 * block` and on.
    pub block: u32,
    /// A bit for each place of the block, the lowest the first.
    pub lanes: u8,
}

/// The two corners of a box: least and greatest.
pub type Corners = [DVec3; 2];

impl BoxBlocks {
    /// The hierarchy over the boxes of `count` items.
    ///
    /// Boxes are finite. Cost: linear, but where many centres crowd in 2^-10 of the size of all, and
    /// again in 2^-10 of that: each time, these are sorted again.
    pub fn new(count: usize, corners: impl Fn(u32) -> Corners) -> Self {
        let boxes = rounded(count, corners);
        Self::over(curve::order(&boxes), &boxes)
    }

    /// The same, for items of which some are in groups: pairs in one group are left out, all but a
    /// few where groups adjoin in the order.
    ///
    /// Nothing is to be found among a hundred thousand faces round one vertex, whose boxes all
    /// overlap there.
    pub fn grouped(
        count: usize,
        corners: impl Fn(u32) -> Corners,
        group: impl Fn(u32) -> Option<u32>,
    ) -> Self {
        let boxes = rounded(count, corners);
        let group = |item: u32| group(item).unwrap_or(MIXED);
        let mut items = curve::order(&boxes);
        items.sort_by_key(|&item| group(item));
        let mut blocks = Self::over(items, &boxes);
        let mut of_places: Vec<u32> =
            blocks.items[..count].iter().map(|&item| group(item)).collect();
        for _ in 0..blocks.levels.len() {
            let same = |chunk: &[u32]| {
                let first = chunk[0];
                if chunk.iter().all(|&group| group == first) { first } else { MIXED }
            };
            of_places = of_places.chunks(LANES).map(same).collect();
            blocks.groups.push(of_places.clone());
        }
        blocks
    }

    /// The hierarchy over items in their order.
    fn over(mut items: Vec<u32>, boxes: &[Box3]) -> Self {
        items.resize(items.len().next_multiple_of(LANES), u32::MAX);
        let leaves = items.chunks_exact(LANES).map(|chunk| {
            Block::of(chunk.iter().map_while(|&item| boxes.get(item as usize).copied()))
        });
        let mut levels = vec![leaves.collect::<Vec<_>>()];
        while levels[levels.len() - 1].len() > 1 {
            let below = &levels[levels.len() - 1];
            let over = below.chunks(LANES).map(|chunk| Block::of(chunk.iter().map(Block::around)));
            levels.push(over.collect());
        }
        Self { items, levels, groups: Vec::new() }
    }

    /// Whether two blocks are of one group, so that there is nothing between them.
    #[inline]
    fn one_group(&self, level: usize, a: usize, b: usize) -> bool {
        let group = |of: &Vec<u32>| of[a] == of[b] && of[a] != MIXED;
        self.groups.get(level).is_some_and(group)
    }

    /// The item at each place of the order, `u32::MAX` where there is none.
    pub fn items(&self) -> &[u32] {
        &self.items
    }

    /// Visits all pairs of items whose boxes overlap, each pair once, a block at a time, until the
    /// visitor breaks. The order is always the same.
    ///
    /// Boxes that only touch overlap. Rounding may add pairs that are 1e-7 of the distance from the
    /// middle of all apart.
    pub fn pairs<B>(&self, visit: &mut impl FnMut(Row) -> ControlFlow<B>) -> ControlFlow<B> {
        let top = self.levels.len() - 1;
        match self.levels[top].first() {
            Some(_) => self.within(top, 0, visit),
            None => ControlFlow::Continue(()),
        }
    }

    /// Pairs of boxes below one block.
    fn within<B>(
        &self,
        level: usize,
        index: usize,
        visit: &mut impl FnMut(Row) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        if self.one_group(level, index, index) {
            return ControlFlow::Continue(());
        }
        let block = &self.levels[level][index];
        for lane in 0..LANES {
            let one = block.lane(lane);
            let after = block.overlapping(&one) & (0xfe << lane) as u8;
            let place = index * LANES + lane;
            if level == 0 {
                self.show(place, index, after, visit)?;
                continue;
            }
            if place < self.levels[level - 1].len() {
                self.within(level - 1, place, visit)?;
            }
            for other in lanes(after) {
                let boxes = [one, block.lane(other)];
                self.between(level - 1, [place, index * LANES + other], boxes, visit)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Pairs of a box below one block and a box below another; the boxes around both are given.
    fn between<B>(
        &self,
        level: usize,
        [a, b]: [usize; 2],
        [around_a, around_b]: [Box3; 2],
        visit: &mut impl FnMut(Row) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let [block_a, block_b] = [a, b].map(|i| &self.levels[level][i]);
        if self.one_group(level, a, b) || block_b.overlapping(&around_a) == 0 {
            return ControlFlow::Continue(());
        }
        for lane in lanes(block_a.overlapping(&around_b)) {
            let one = block_a.lane(lane);
            let with = block_b.overlapping(&one);
            let place = a * LANES + lane;
            if level == 0 {
                self.show(place, b, with, visit)?;
                continue;
            }
            for other in lanes(with) {
                let boxes = [one, block_b.lane(other)];
                self.between(level - 1, [place, b * LANES + other], boxes, visit)?;
            }
        }
        ControlFlow::Continue(())
    }

    #[inline]
    fn show<B>(
        &self,
        one: usize,
        block: usize,
        lanes: u8,
        visit: &mut impl FnMut(Row) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        match lanes {
            0 => ControlFlow::Continue(()),
            lanes => visit(Row { one: one as u32, block: block as u32, lanes }),
        }
    }
}

/// The boxes in `f32`.
fn rounded(count: usize, corners: impl Fn(u32) -> Corners) -> Vec<Box3> {
    let frame = Middle::of(count, &corners);
    (0..count as u32).map(|i| frame.rounded(corners(i))).collect()
}

/// The set bits, lowest first.
#[inline]
pub fn lanes(bits: u8) -> Bits {
    Bits(u32::from(bits))
}

/// See [`lanes`].
#[derive(Clone, Copy, Debug)]
pub struct Bits(u32);

impl Iterator for Bits {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}

impl Block {
    /// A block of up to eight boxes.
    fn of(boxes: impl Iterator<Item = Box3>) -> Self {
        let empty = [[Box3::EMPTY.lo.x; LANES / 2]; 2];
        let mut block = Self { lo: [empty; 3], hi: [empty.map(|half| half.map(|x| -x)); 3] };
        for (lane, one) in boxes.enumerate() {
            let (half, lane) = (lane / 4, lane % 4);
            for axis in 0..3 {
                block.lo[axis][half][lane] = one.lo[axis];
                block.hi[axis][half][lane] = one.hi[axis];
            }
        }
        block
    }

    #[inline]
    fn lane(&self, lane: usize) -> Box3 {
        let pick = |[x, y, z]: &[Lanes; 3]| {
            let (half, lane) = (lane / 4 % 2, lane % 4);
            Vec3::new(x[half][lane], y[half][lane], z[half][lane])
        };
        Box3 { lo: pick(&self.lo), hi: pick(&self.hi) }
    }

    fn around(&self) -> Box3 {
        let least = |lanes: &Lanes| Vec4::from(lanes[0]).min(lanes[1].into()).min_element();
        let greatest = |lanes: &Lanes| Vec4::from(lanes[0]).max(lanes[1].into()).max_element();
        let [lo, hi] = [self.lo.each_ref().map(least), self.hi.each_ref().map(greatest)];
        Box3 { lo: lo.into(), hi: hi.into() }
    }

    /// A bit for each lane whose box overlaps.
    #[inline]
    fn overlapping(&self, other: &Box3) -> u8 {
        let half = |half: usize| {
            let along = |axis: usize| {
                let lo = Vec4::from_array(self.lo[axis][half]);
                let hi = Vec4::from_array(self.hi[axis][half]);
                lo.cmple(Vec4::splat(other.hi[axis])) & hi.cmpge(Vec4::splat(other.lo[axis]))
            };
            (along(0) & along(1) & along(2)).bitmask()
        };
        (half(0) | half(1) << 4) as u8
    }
}

#[cfg(test)]
mod tests;
