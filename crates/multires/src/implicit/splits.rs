//! Updates as seen from their coarse sides, in 16 bytes each, or 10 in compact form.

use super::compact::CompactSplits;
use crate::length16::Length16;

/// All updates of a model.
#[derive(Clone, Debug)]
pub(super) enum Splits {
    Full(Vec<Split>),
    Compact(CompactSplits),
}

/// An update seen from its coarse side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Split {
    /// Node that is split; the highest bit marks an update fused with the split of its first child.
    pub(super) parent: u32,
    /// First update after those of the first child; the highest bit is set if it belongs to the
    /// second child.
    pub(super) second: u32,
    pub(super) local: Local,
}

/// Attributes of an update besides its place in the forest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Local {
    pub(super) radius: Length16,
    pub(super) error: Length16,
    /// Level; the highest bit is set if a neighbour has no face after it.
    pub(super) level: u16,
    pub(super) wings: [u8; 2],
}

impl Splits {
    #[inline]
    pub(super) fn parent(&self, update: u32) -> u32 {
        match self {
            Self::Full(splits) => splits[update as usize].parent,
            Self::Compact(compact) => compact.parent(update),
        }
    }

    #[inline]
    pub(super) fn second(&self, update: u32) -> u32 {
        match self {
            Self::Full(splits) => splits[update as usize].second,
            Self::Compact(compact) => compact.second(update),
        }
    }

    #[inline]
    pub(super) fn local(&self, update: u32) -> Local {
        match self {
            Self::Full(splits) => splits[update as usize].local,
            Self::Compact(compact) => compact.local(update),
        }
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Self::Full(splits) => splits.len(),
            Self::Compact(compact) => compact.len(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Full(splits) => size_of_val(&splits[..]),
            Self::Compact(compact) => compact.bytes(),
        }
    }

    /// Returns the updates in compact form, or `None` if some number does not fit.
    pub(super) fn compacted(&self, roots: u32) -> Option<Self> {
        match self {
            Self::Full(splits) => CompactSplits::new(splits, roots).map(Self::Compact),
            Self::Compact(_) => Some(self.clone()),
        }
    }
}
