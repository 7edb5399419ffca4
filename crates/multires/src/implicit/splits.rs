//! What updates are, from their coarse sides: 16 bytes each, or 10.

use super::compact::CompactSplits;
use crate::frame::Length16;

/// All updates of a model.
#[derive(Clone, Debug)]
pub(super) enum Splits {
    Full(Vec<Split>),
    Compact(CompactSplits),
}

/// An update, from its coarse side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Split {
    /// The node; its highest bit is set where the first child is split in the same go.
    pub(super) parent: u32,
    /// The update behind those of the first child; its highest bit is set where it is the second
    /// child's.
    pub(super) second: u32,
    pub(super) local: Local,
}

/// What an update tells beside its place in the forest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Local {
    pub(super) radius: Length16,
    pub(super) error: Length16,
    /// Its highest bit is set where around the vertex is one whom no face follows.
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

    /// The same in less room; `None` where numbers are too large for that.
    pub(super) fn compacted(&self, roots: u32) -> Option<Self> {
        match self {
            Self::Full(splits) => CompactSplits::new(splits, roots).map(Self::Compact),
            Self::Compact(_) => Some(self.clone()),
        }
    }
}
