//! Compact form of the updates, in 10 bytes each.
//!
//! In depth-first order an update splits the first child of the update before it, or the second
//! child of one not far behind, and its second child's updates are not far ahead. Both are stored
//! as 16-bit distances. The exceptions go to side tables: the updates of roots, and those with
//! 65,534 or more updates between their children. Levels are stored relative to the least level of
//! the same error, as in a file.

use super::splits::{Local, Split};
use super::{FLAG, OPEN};
use crate::length16::Length16;
use crate::pack::{ERRORS, error9, error16, radius8, radius16};

#[derive(Clone, Debug)]
pub(super) struct CompactSplits {
    roots: u32,
    splits: Vec<CompactSplit>,
    /// Minimum level of an update, by its error.
    bottoms: Box<[u16; ERRORS]>,
    /// Updates whose parent is too far for a distance, in order.
    far_parents: Vec<[u32; 2]>,
    far_seconds: Vec<[u32; 2]>,
}

#[derive(Clone, Copy, Debug)]
struct CompactSplit {
    /// 0 if it splits the first child of the update before it; otherwise the distance back to the
    /// update whose second child it splits, or [`FAR`].
    behind: u16,
    /// Number of updates below its first child, or [`FAR`].
    below: u16,
    wings: [u8; 2],
    radius: u8,
    /// Low bits of its level above the least one of its error.
    height: u8,
    /// Nine bits of error, four high bits of its relative level, and three flags.
    more: u16,
}

const FAR: u16 = u16::MAX;

const ERROR_BITS: u32 = 9;
const HEIGHT_BITS: u32 = 4;
const FUSED: u16 = 1 << 13;
const SECOND: u16 = 1 << 14;
const IS_OPEN: u16 = 1 << 15;

impl CompactSplits {
    /// Packs all updates, or returns `None` if a radius or an error has more bits than the compact
    /// form keeps or an error has 4,096 levels or more.
    pub(super) fn new(splits: &[Split], roots: u32) -> Option<Self> {
        let level = |split: &Split| split.local.level & !OPEN;
        let mut bottoms = Box::new([u16::MAX; ERRORS]);
        for split in splits {
            let bottom = &mut bottoms[error9(split.local.error) as usize];
            *bottom = level(split).min(*bottom);
        }
        let mut this = Self {
            roots,
            splits: Vec::with_capacity(splits.len()),
            bottoms,
            far_parents: Vec::new(),
            far_seconds: Vec::new(),
        };
        for (update, split) in (0..).zip(splits) {
            let packed = this.pack(update, split)?;
            this.splits.push(packed);
        }
        let is_the_same = |(update, split): (u32, &Split)| this.split(update) == *split;
        (0..).zip(splits).all(is_the_same).then_some(this)
    }

    /// Packs an update, rounding whatever has too many bits.
    fn pack(&mut self, update: u32, split: &Split) -> Option<CompactSplit> {
        let (parent, second, local) = (split.parent & !FLAG, split.second & !FLAG, split.local);
        let behind = match parent.checked_sub(self.roots) {
            Some(child) if child % 2 == 0 => Some(0),
            Some(child) => near(update - child / 2),
            None => None,
        };
        if behind.is_none() {
            self.far_parents.push([update, parent]);
        }
        let below = near(second - update - 1);
        if below.is_none() {
            self.far_seconds.push([update, second]);
        }
        let error = error9(local.error);
        let height = (local.level & !OPEN) - self.bottoms[error as usize];
        let high = height >> u8::BITS;
        let flag = |is_set: bool, flag: u16| if is_set { flag } else { 0 };
        (high < 1 << HEIGHT_BITS).then(|| CompactSplit {
            behind: behind.unwrap_or(FAR),
            below: below.unwrap_or(FAR),
            wings: local.wings,
            radius: radius8(local.radius),
            height: height as u8,
            more: error as u16
                | high << ERROR_BITS
                | flag(split.parent & FLAG != 0, FUSED)
                | flag(split.second & FLAG != 0, SECOND)
                | flag(local.level & OPEN != 0, IS_OPEN),
        })
    }

    #[inline]
    fn split(&self, update: u32) -> Split {
        let (parent, second) = (self.parent(update), self.second(update));
        Split { parent, second, local: self.local(update) }
    }

    #[inline]
    pub(super) fn parent(&self, update: u32) -> u32 {
        let CompactSplit { behind, more, .. } = self.splits[update as usize];
        let parent = match behind {
            0 => self.roots + 2 * (update - 1),
            FAR => find(&self.far_parents, update),
            behind => self.roots + 2 * (update - u32::from(behind)) + 1,
        };
        parent | if more & FUSED != 0 { FLAG } else { 0 }
    }

    #[inline]
    pub(super) fn second(&self, update: u32) -> u32 {
        let CompactSplit { below, more, .. } = self.splits[update as usize];
        let second = match below {
            FAR => find(&self.far_seconds, update),
            below => update + 1 + u32::from(below),
        };
        second | if more & SECOND != 0 { FLAG } else { 0 }
    }

    #[inline]
    pub(super) fn local(&self, update: u32) -> Local {
        let CompactSplit { wings, radius, height, more, .. } = self.splits[update as usize];
        let error = more & ((1 << ERROR_BITS) - 1);
        let high = (more >> ERROR_BITS) & ((1 << HEIGHT_BITS) - 1);
        let level = self.bottoms[usize::from(error)] + (high << u8::BITS | u16::from(height));
        Local {
            radius: radius16(radius),
            error: error16(error.into()).unwrap_or(Length16::INFINITE),
            level: level | if more & IS_OPEN != 0 { OPEN } else { 0 },
            wings,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.splits.len()
    }

    pub(super) fn bytes(&self) -> usize {
        let far = [&self.far_parents, &self.far_seconds];
        size_of_val(&self.splits[..])
            + size_of_val(&self.bottoms[..])
            + far.iter().map(|far| size_of_val(&far[..])).sum::<usize>()
    }
}

/// Returns a distance as stored, or `None` if it is too large.
fn near(distance: u32) -> Option<u16> {
    u16::try_from(distance).ok().filter(|&near| near != FAR)
}

#[cold]
fn find(far: &[[u32; 2]], update: u32) -> u32 {
    let at = far.binary_search_by_key(&update, |&[update, _]| update);
    far[at.expect("it was put there when it was packed")][1]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A root whose first child starts a long chain of first children, and whose second child has
    /// one update.
    fn chain(length: u32) -> Vec<Split> {
        let local = |level: u16| Local {
            radius: radius16(9),
            error: error16(77).unwrap(),
            level,
            wings: [3, 200],
        };
        let mut splits = Vec::new();
        for update in 0..length {
            let parent = if update == 0 { 0 } else { 1 + 2 * (update - 1) };
            let second = if update == 0 { length | FLAG } else { length };
            let level = 100 + (length - update).min(4000) as u16;
            splits.push(Split { parent, second, local: local(level) });
        }
        splits.push(Split { parent: 2 | FLAG, second: length + 1, local: local(100 | OPEN) });
        splits
    }

    #[test]
    fn short_and_long_distances_come_back() {
        for length in [1, 2, 1000, 65_534, 65_535, 65_536, 70_000] {
            let splits = chain(length);
            let compact = CompactSplits::new(&splits, 1).unwrap();
            let same = |(update, split): (u32, &Split)| compact.split(update) == *split;
            assert!((0..).zip(&splits).all(same), "{length}");
            let far = compact.far_parents.len() + compact.far_seconds.len();
            assert_eq!(far > 1, length >= 65_535, "{length}: {far}");
        }
    }

    #[test]
    fn what_would_change_is_not_compacted() {
        let mut splits = chain(2);
        splits[1].local.radius.0 += 1;
        assert!(CompactSplits::new(&splits, 1).is_none(), "a radius of more bits");
        let mut splits = chain(2);
        splits[1].local.level = 100 + 4096;
        assert!(CompactSplits::new(&splits, 1).is_none(), "too many levels of one error");
    }
}
