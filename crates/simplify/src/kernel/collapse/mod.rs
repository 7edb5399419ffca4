//! An edge contraction as it is decided: its ends, the wedges that meet along it, and the new place.

pub(crate) mod deviation;
pub(crate) mod edge_ring;

use glam::{DVec3, Vec3};

/// The ends of an edge that may be contracted: `v1` goes into `v0`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Ends {
    pub(crate) v0: u32,
    pub(crate) v1: u32,
    /// Whether the new vertex may go anywhere, or is where `v0` is.
    pub(crate) free: bool,
    /// Which of their slots become one.
    pub(crate) wedge_pairs: WedgePairs,
}

impl Ends {
    /// Where nothing is in the way.
    #[inline(always)]
    pub(crate) fn free(v0: u32, v1: u32) -> Self {
        Self { v0, v1, free: true, wedge_pairs: WedgePairs::smooth(v0, v1) }
    }
}

/// A contraction that is about to be carried out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Collapse {
    pub(crate) ends: Ends,
    /// Half the edge.
    pub(crate) half: DVec3,
    /// The new place as seen from the middle.
    pub(crate) from_middle: DVec3,
    /// The new place, as rounded.
    pub(crate) place: Vec3,
    /// The same as seen from `v0`.
    pub(crate) displacement: Vec3,
}

/// The slots that meet along an edge, of `v0` and of `v1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct WedgePairs {
    /// On each side of the edge, as seen from `v0` and from `v1`.
    pub(crate) sides: [WedgeSides; 2],
    pub(crate) pairs: [[u32; 2]; 2],
    /// Whether the second pair is another than the first.
    pub(crate) are_two: bool,
    /// Whether an end has slots that are in no pair.
    pub(crate) has_unpaired: [bool; 2],
}

impl WedgePairs {
    /// Where vertices are slots.
    #[inline(always)]
    pub(crate) fn smooth(v0: u32, v1: u32) -> Self {
        let sides = [WedgeSides { before: v0, after: v0 }, WedgeSides { before: v1, after: v1 }];
        Self { sides, pairs: [[v0, v1]; 2], are_two: false, has_unpaired: [false; 2] }
    }

    /// Where one side has no face, it has the slots of the other.
    #[inline(always)]
    pub(crate) fn new(at0: WedgeSides, at1: WedgeSides, has_unpaired: [bool; 2]) -> Self {
        let pairs = [[at0.after, at1.before], [at0.before, at1.after]];
        Self { sides: [at0, at1], pairs, are_two: pairs[0] != pairs[1], has_unpaired }
    }

    /// One pair, or one on each side.
    #[inline(always)]
    pub(crate) fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs[..1 + usize::from(self.are_two)]
    }

    /// The pair of the other side, if it is another.
    #[inline(always)]
    pub(crate) fn other(&self) -> Option<[u32; 2]> {
        self.are_two.then_some(self.pairs[1])
    }

    /// Whether a slot of an end is in no pair.
    #[inline(always)]
    pub(crate) fn is_unpaired(&self, end: usize, slot: u32) -> bool {
        slot != self.pairs[0][end] && !(self.are_two && slot == self.pairs[1][end])
    }

    /// As seen from the other end.
    #[inline(always)]
    pub(crate) fn turned(&self) -> Self {
        let ([at0, at1], [of_v0, of_v1]) = (self.sides, self.has_unpaired);
        Self::new(at1, at0, [of_v1, of_v0])
    }
}

/// The slots of a vertex in the two faces on an edge from it, seen counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct WedgeSides {
    /// In the face that ends at the neighbour.
    pub(crate) before: u32,
    /// In the one that begins there.
    pub(crate) after: u32,
}
