//! Nodes and directed edges of the dual graph, in 16 and 4 bytes.

/// Directed edge of the dual graph: a face and one of its sides, packed into 32 bits.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct DualEdge(u32);

impl DualEdge {
    /// Marks a side without a neighbour.
    pub(crate) const NONE: DualEdge = DualEdge(u32::MAX);

    /// Largest number of nodes; the sides of one more could equal [`DualEdge::NONE`].
    pub(crate) const MAX_NODES: usize = (u32::MAX / 4) as usize;

    #[inline]
    pub(crate) fn new(node: usize, side: usize) -> Self {
        Self((node as u32) << 2 | side as u32)
    }

    #[inline]
    pub(crate) fn node(self) -> usize {
        (self.0 >> 2) as usize
    }

    #[inline]
    pub(crate) fn side(self) -> usize {
        (self.0 & 3) as usize
    }

    #[inline]
    pub(crate) fn is_none(self) -> bool {
        self == Self::NONE
    }
}

/// Set of linked sides of a node: bit k for side k, at most two bits set.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(crate) struct Links(u8);

impl Links {
    #[inline]
    pub(crate) fn has(self, side: usize) -> bool {
        self.0 >> side & 1 != 0
    }

    /// Returns the set with one side toggled.
    #[inline]
    pub(crate) fn toggled(self, side: usize) -> Self {
        Self(self.0 ^ 1 << side)
    }

    #[inline]
    pub(crate) fn with(self, side: usize) -> Self {
        Self(self.0 | 1 << side)
    }

    #[inline]
    pub(crate) fn without(self, side: usize) -> Self {
        Self(self.0 & !(1 << side))
    }

    /// Returns the number of linked sides.
    #[inline]
    pub(crate) fn count(self) -> usize {
        (self.bits() & 1) + (self.bits() >> 1 & 1) + (self.bits() >> 2)
    }

    /// Returns the lowest linked side.
    #[inline]
    pub(crate) fn first(self) -> Option<usize> {
        (self.bits() != 0).then(|| self.bits().trailing_zeros() as usize)
    }

    /// Returns the set as a number below 8.
    #[inline]
    pub(crate) fn bits(self) -> usize {
        (self.0 & 7) as usize
    }
}

/// Node of the dual graph, a face: its neighbours across each side, and which sides are linked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DualNode {
    pub(crate) across: [DualEdge; 3],
    pub(crate) links: Links,
    /// True if its links must not change for now.
    pub(crate) frozen: bool,
}

impl DualNode {
    /// A node without neighbours.
    pub(crate) const ISOLATED: Self =
        Self { across: [DualEdge::NONE; 3], links: Links(0), frozen: false };
}
