//! Finds overlapping boxes: a bounding volume hierarchy of eight boxes a node, built along a
//! space-filling curve and tested against itself.

mod frame;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;

use glam::{DVec3, Vec3, Vec4};
use meshlod_spatial::curve_order;

use frame::FloatFrame;

/// Number of boxes in a block, which is also the number of children of a tree node: one per SIMD
/// lane.
pub(crate) const LANES: usize = 8;

/// A bounding volume hierarchy that finds all pairs of overlapping boxes.
///
/// Boxes are sorted along a space-filling curve and packed into blocks of eight; blocks are packed
/// into blocks of the next level. Building is a sort and one pass, so it pays for a single query.
/// Size: 27 bytes a box.
#[derive(Clone, Debug)]
pub(crate) struct BoxBlocks {
    /// Item in each slot, a slot being a position in the sorted order. Blocks are whole: the last
    /// is filled up with `u32::MAX`.
    items: Vec<u32>,
    /// Blocks of each level, from the blocks of items up to a single root.
    levels: Vec<Vec<Block>>,
    /// Group of each block of each level, [`MIXED`] for several; empty without groups.
    groups: Vec<Vec<u32>>,
}

/// Group of an item without a group, and of a block with several.
const MIXED: u32 = u32::MAX;

/// A box in `f32`, given by its least and greatest corners.
#[derive(Clone, Copy, Debug)]
struct BoxF32 {
    lo: Vec3,
    hi: Vec3,
}

/// Eight boxes stored by axis, one lane a box. An empty lane overlaps nothing.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Block {
    lo: [Lanes; 3],
    hi: [Lanes; 3],
}

/// Eight lanes as two halves of four, the width of one SIMD comparison.
type Lanes = [[f32; LANES / 2]; 2];

/// The boxes of one block that overlap one other box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OverlapRow {
    /// Slot of the single box.
    pub(crate) slot: usize,
    /// Index of the block; its slots start at `LANES * block`.
    pub(crate) block: usize,
    /// Bit mask of the boxes in the block that overlap the single box; the lowest bit is the first
    /// slot of the block.
    pub(crate) lanes: u8,
}

impl OverlapRow {
    /// Iterates over the slots of the overlapping boxes of the block, lowest first.
    #[inline]
    pub(crate) fn others(self) -> impl Iterator<Item = usize> {
        SetBits(u32::from(self.lanes)).map(move |lane| self.block * LANES + lane)
    }
}

/// Minimum and maximum corner of a box.
pub(crate) type Corners = [DVec3; 2];

impl BoxBlocks {
    /// Builds the hierarchy over the boxes of `count` items. All coordinates must be finite.
    ///
    /// Cost: linear, except that crowds of centres within 2^-10 of the overall size are sorted
    /// again, as are crowds within 2^-10 of that, and so on.
    pub(crate) fn new(count: usize, corners: impl Fn(u32) -> Corners) -> Self {
        let boxes = rounded(count, corners);
        Self::over(sorted_along_curve(&boxes), &boxes)
    }

    /// Builds the hierarchy over items that may belong to groups: pairs within a group are skipped,
    /// except for a few where groups adjoin in the sorted order.
    ///
    /// Skipping matters for, say, a hundred thousand faces around one vertex, whose boxes all
    /// overlap.
    pub(crate) fn grouped(
        count: usize,
        corners: impl Fn(u32) -> Corners,
        group: impl Fn(u32) -> Option<u32>,
    ) -> Self {
        let boxes = rounded(count, corners);
        let group = |item: u32| group(item).unwrap_or(MIXED);
        let mut items = sorted_along_curve(&boxes);
        items.sort_by_key(|&item| group(item));
        let mut blocks = Self::over(items, &boxes);
        let mut groups: Vec<u32> = blocks.items[..count].iter().map(|&item| group(item)).collect();
        for _ in 0..blocks.levels.len() {
            let same = |chunk: &[u32]| {
                let first = chunk[0];
                if chunk.iter().all(|&group| group == first) { first } else { MIXED }
            };
            groups = groups.chunks(LANES).map(same).collect();
            blocks.groups.push(groups.clone());
        }
        blocks
    }

    /// Builds the levels over items already in order.
    fn over(mut items: Vec<u32>, boxes: &[BoxF32]) -> Self {
        items.resize(items.len().next_multiple_of(LANES), u32::MAX);
        let leaves = items.chunks_exact(LANES).map(|chunk| {
            Block::of(chunk.iter().map_while(|&item| boxes.get(item as usize).copied()))
        });
        let mut levels = vec![leaves.collect::<Vec<_>>()];
        while levels[levels.len() - 1].len() > 1 {
            let below = &levels[levels.len() - 1];
            let above = below.chunks(LANES).map(|chunk| Block::of(chunk.iter().map(Block::bounds)));
            levels.push(above.collect());
        }
        Self { items, levels, groups: Vec::new() }
    }

    /// Returns true if two blocks are of one group, so that no pair between them counts.
    #[inline]
    fn same_group(&self, level: usize, a: usize, b: usize) -> bool {
        let group = |of: &Vec<u32>| of[a] == of[b] && of[a] != MIXED;
        self.groups.get(level).is_some_and(group)
    }

    /// Returns the item in each slot of the sorted order; an empty slot holds `u32::MAX`.
    pub(crate) fn items(&self) -> &[u32] {
        &self.items
    }

    /// Visits every pair of overlapping boxes once, one [`OverlapRow`] at a time, until the visitor
    /// breaks. The order is deterministic.
    ///
    /// Boxes that only touch overlap. Rounding may add pairs that are apart by up to 1e-7 of their
    /// distance from the centre of all boxes.
    pub(crate) fn pairs<B>(
        &self,
        visit: &mut impl FnMut(OverlapRow) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let top = self.levels.len() - 1;
        match self.levels[top].first() {
            Some(_) => self.within(top, 0, visit),
            None => ControlFlow::Continue(()),
        }
    }

    /// Visits the pairs of boxes below one block.
    fn within<B>(
        &self,
        level: usize,
        index: usize,
        visit: &mut impl FnMut(OverlapRow) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        if self.same_group(level, index, index) {
            return ControlFlow::Continue(());
        }
        let block = &self.levels[level][index];
        for lane in 0..LANES {
            let one = block.lane(lane);
            let after = block.overlapping(&one) & (0xfe << lane) as u8;
            let child = index * LANES + lane;
            let row = OverlapRow { slot: child, block: index, lanes: after };
            if level == 0 {
                visit_nonempty(row, visit)?;
                continue;
            }
            if child < self.levels[level - 1].len() {
                self.within(level - 1, child, visit)?;
            }
            for other in row.others() {
                let boxes = [one, block.lane(other % LANES)];
                self.between(level - 1, [child, other], boxes, visit)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Visits the pairs of a box below block `a` and a box below block `b`, given the bounds of
    /// both.
    fn between<B>(
        &self,
        level: usize,
        [a, b]: [usize; 2],
        [bounds_a, bounds_b]: [BoxF32; 2],
        visit: &mut impl FnMut(OverlapRow) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let [block_a, block_b] = [a, b].map(|i| &self.levels[level][i]);
        if self.same_group(level, a, b) || block_b.overlapping(&bounds_a) == 0 {
            return ControlFlow::Continue(());
        }
        for lane in SetBits(u32::from(block_a.overlapping(&bounds_b))) {
            let one = block_a.lane(lane);
            let child = a * LANES + lane;
            let row = OverlapRow { slot: child, block: b, lanes: block_b.overlapping(&one) };
            if level == 0 {
                visit_nonempty(row, visit)?;
                continue;
            }
            for other in row.others() {
                let boxes = [one, block_b.lane(other % LANES)];
                self.between(level - 1, [child, other], boxes, visit)?;
            }
        }
        ControlFlow::Continue(())
    }
}

#[inline]
fn visit_nonempty<B>(
    row: OverlapRow,
    visit: &mut impl FnMut(OverlapRow) -> ControlFlow<B>,
) -> ControlFlow<B> {
    if row.lanes == 0 { ControlFlow::Continue(()) } else { visit(row) }
}

/// Converts the boxes to `f32`.
fn rounded(count: usize, corners: impl Fn(u32) -> Corners) -> Vec<BoxF32> {
    let frame = FloatFrame::of(count, &corners);
    (0..count as u32).map(|i| frame.rounded(corners(i))).collect()
}

/// Returns the indices of the boxes, sorted by their centres along a space-filling curve.
fn sorted_along_curve(boxes: &[BoxF32]) -> Vec<u32> {
    // Doubled centres sort alike.
    let centers: Vec<[f32; 3]> = boxes.iter().map(|of| (of.lo + of.hi).to_array()).collect();
    curve_order(&centers)
}

/// Iterator over the set bits of a mask, lowest first.
#[derive(Clone, Copy, Debug)]
struct SetBits(u32);

impl Iterator for SetBits {
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
    /// Packs up to eight boxes.
    fn of(boxes: impl Iterator<Item = BoxF32>) -> Self {
        let empty = [[f32::INFINITY; LANES / 2]; 2];
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
    fn lane(&self, lane: usize) -> BoxF32 {
        let pick = |[x, y, z]: &[Lanes; 3]| {
            let (half, lane) = (lane / 4 % 2, lane % 4);
            Vec3::new(x[half][lane], y[half][lane], z[half][lane])
        };
        BoxF32 { lo: pick(&self.lo), hi: pick(&self.hi) }
    }

    fn bounds(&self) -> BoxF32 {
        let least = |lanes: &Lanes| Vec4::from(lanes[0]).min(lanes[1].into()).min_element();
        let greatest = |lanes: &Lanes| Vec4::from(lanes[0]).max(lanes[1].into()).max_element();
        let [lo, hi] = [self.lo.each_ref().map(least), self.hi.each_ref().map(greatest)];
        BoxF32 { lo: lo.into(), hi: hi.into() }
    }

    /// Returns a mask with one bit for each lane whose box overlaps `other`.
    #[inline]
    fn overlapping(&self, other: &BoxF32) -> u8 {
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
