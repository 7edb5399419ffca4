//! What updates are, from their coarse sides: 16 bytes each, or 10.

use super::narrow::Narrow;
use crate::frame::Length16;

/// All updates of a model.
#[derive(Clone, Debug)]
pub(super) enum Splits {
    Wide(Vec<Split>),
    Narrow(Narrow),
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
            Self::Wide(splits) => splits[update as usize].parent,
            Self::Narrow(narrow) => narrow.parent(update),
        }
    }

    #[inline]
    pub(super) fn second(&self, update: u32) -> u32 {
        match self {
            Self::Wide(splits) => splits[update as usize].second,
            Self::Narrow(narrow) => narrow.second(update),
        }
    }

    #[inline]
    pub(super) fn local(&self, update: u32) -> Local {
        match self {
            Self::Wide(splits) => splits[update as usize].local,
            Self::Narrow(narrow) => narrow.local(update),
        }
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Self::Wide(splits) => splits.len(),
            Self::Narrow(narrow) => narrow.len(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Wide(splits) => size_of_val(&splits[..]),
            Self::Narrow(narrow) => narrow.bytes(),
        }
    }

    /// The same in less room; `None` where numbers are too large for that.
    pub(super) fn narrowed(&self, roots: u32) -> Option<Self> {
        match self {
            Self::Wide(splits) => Narrow::new(splits, roots).map(Self::Narrow),
            Self::Narrow(_) => Some(self.clone()),
        }
    }
}
