//! Pairs of boxes that overlap: blocks of eight, in an order along a curve, one level over the other.

use std::ops::ControlFlow;

use glam::{DVec3, Vec3, Vec4};

use crate::curve;

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
}

/// Eight boxes, axis by axis, one lane a box. A lane without a box overlaps nothing.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Block {
    lo: [[Vec4; 2]; 3],
    hi: [[Vec4; 2]; 3],
}

/// One box, rounded.
#[derive(Clone, Copy, Debug)]
struct Box3 {
    lo: Vec3,
    hi: Vec3,
}

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
    /// Boxes are finite. Cost: linear, but for items whose centres crowd together within 2^-20 of
    /// the size of all: sorting these again costs as much as they are deep.
    pub fn new(count: usize, corners: impl Fn(u32) -> Corners) -> Self {
        let mut items = curve::order(count, &corners);
        let frame = curve::Middle::of(count, &corners);
        items.resize(count.next_multiple_of(LANES), u32::MAX);
        let leaves = items.chunks_exact(LANES).map(|chunk| {
            Block::of(|lane| match chunk[lane] {
                u32::MAX => Box3::EMPTY,
                item => frame.rounded(corners(item)),
            })
        });
        let mut levels = vec![leaves.collect::<Vec<_>>()];
        while levels[levels.len() - 1].len() > 1 {
            let below = &levels[levels.len() - 1];
            let over = below
                .chunks(LANES)
                .map(|chunk| Block::of(|lane| chunk.get(lane).map_or(Box3::EMPTY, Block::around)));
            levels.push(over.collect());
        }
        Self { items, levels }
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
        let block = &self.levels[level][index];
        for lane in 0..LANES {
            let after = block.overlapping(&block.lane(lane)) & (0xfe << lane) as u8;
            let one = index * LANES + lane;
            if level == 0 {
                self.show(one, index, after, visit)?;
                continue;
            }
            if one < self.levels[level - 1].len() {
                self.within(level - 1, one, visit)?;
            }
            for other in lanes(after) {
                self.between(level - 1, one, index * LANES + other, visit)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Pairs of a box below block `a` and one below block `b`.
    fn between<B>(
        &self,
        level: usize,
        a: usize,
        b: usize,
        visit: &mut impl FnMut(Row) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let [block_a, block_b] = [a, b].map(|i| &self.levels[level][i]);
        let near_b = block_a.overlapping(&block_b.around());
        let near_a = block_b.overlapping(&block_a.around());
        for lane in lanes(near_b) {
            let with = block_b.overlapping(&block_a.lane(lane)) & near_a;
            let one = a * LANES + lane;
            if level == 0 {
                self.show(one, b, with, visit)?;
                continue;
            }
            for other in lanes(with) {
                self.between(level - 1, one, b * LANES + other, visit)?;
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

/// The set bits.
#[inline]
pub fn lanes(mut bits: u8) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = (bits != 0).then(|| bits.trailing_zeros() as usize);
        bits &= bits.wrapping_sub(1);
        lane
    })
}

impl Block {
    fn of(one: impl Fn(usize) -> Box3) -> Self {
        let mut block = Self { lo: [[Vec4::ZERO; 2]; 3], hi: [[Vec4::ZERO; 2]; 3] };
        for lane in 0..LANES {
            let one = one(lane);
            for axis in 0..3 {
                block.lo[axis][lane / 4][lane % 4] = one.lo[axis];
                block.hi[axis][lane / 4][lane % 4] = one.hi[axis];
            }
        }
        block
    }

    #[inline]
    fn lane(&self, lane: usize) -> Box3 {
        let pick = |sides: &[[Vec4; 2]; 3]| {
            Vec3::from_array(std::array::from_fn(|axis| sides[axis][lane / 4][lane % 4]))
        };
        Box3 { lo: pick(&self.lo), hi: pick(&self.hi) }
    }

    #[inline]
    fn around(&self) -> Box3 {
        let least = |sides: [Vec4; 2]| sides[0].min(sides[1]).min_element();
        let greatest = |sides: [Vec4; 2]| sides[0].max(sides[1]).max_element();
        Box3 {
            lo: Vec3::from_array(self.lo.map(least)),
            hi: Vec3::from_array(self.hi.map(greatest)),
        }
    }

    /// A bit for each lane whose box overlaps.
    #[inline]
    fn overlapping(&self, other: &Box3) -> u8 {
        let half = |h: usize| {
            let mut all = self.lo[0][h].cmple(Vec4::splat(other.hi.x))
                & self.hi[0][h].cmpge(Vec4::splat(other.lo.x));
            for axis in 1..3 {
                all &= self.lo[axis][h].cmple(Vec4::splat(other.hi[axis]))
                    & self.hi[axis][h].cmpge(Vec4::splat(other.lo[axis]));
            }
            all.bitmask()
        };
        (half(0) | half(1) << 4) as u8
    }
}

impl Box3 {
    const EMPTY: Self = Self { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };
}

impl curve::Middle {
    /// The box in `f32`, about the middle. Rounding keeps the order of numbers, so boxes that
    /// overlap still do.
    #[inline]
    fn rounded(&self, [lo, hi]: Corners) -> Box3 {
        Box3 { lo: self.local(lo).as_vec3(), hi: self.local(hi).as_vec3() }
    }
}
