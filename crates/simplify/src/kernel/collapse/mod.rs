//! One edge contraction: its ends, the wedges paired along the edge, and the new position.

pub(crate) mod deviation;
pub(crate) mod edge_ring;

use glam::{DVec3, Vec3};

/// Ends of an edge to be contracted: `v1` is contracted into `v0`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Ends {
    pub(crate) v0: u32,
    pub(crate) v1: u32,
    pub(crate) mobility: Mobility,
    /// True if a seam gives way: a chart at `v0` or `v1` does not go on along the edge.
    pub(crate) cuts_seam: bool,
    /// Slots of the two ends that become one.
    pub(crate) wedge_pairs: WedgePairs,
}

impl Ends {
    /// Returns the ends of an edge that nothing constrains.
    #[inline(always)]
    pub(crate) fn free(v0: u32, v1: u32) -> Self {
        let wedge_pairs = WedgePairs::smooth(v0, v1);
        Self { v0, v1, mobility: Mobility::Free, cuts_seam: false, wedge_pairs }
    }

    /// Returns true if the new vertex may be anywhere.
    #[inline(always)]
    pub(crate) fn is_free(&self) -> bool {
        matches!(self.mobility, Mobility::Free | Mobility::Leaning)
    }
}

/// Positions allowed for the new vertex of a contraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mobility {
    /// Any position.
    Free,
    /// Any position, but that of `v0` where it is as good: charts or materials meet there that do
    /// not meet at `v1`, so its place and its values say where they do.
    Leaning,
    /// Positions on the surface's normal at `v0`: a seam holds the vertex, and its texture must not
    /// slide.
    AlongNormal,
    /// The position of `v0` alone: a pin or a tie holds the vertex.
    Fixed,
}

/// An edge contraction about to be carried out.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Collapse {
    pub(crate) ends: Ends,
    /// Half of the vector along the edge.
    pub(crate) half: DVec3,
    /// Optimal position of the new vertex relative to the middle of the edge, before rounding.
    pub(crate) from_middle: DVec3,
    /// Position of the new vertex, rounded to floats.
    pub(crate) place: Vec3,
    /// Position of the new vertex relative to `v0`.
    pub(crate) displacement: Vec3,
}

impl Collapse {
    /// Returns true if the new vertex could be at the position of `v0` alone.
    pub(crate) fn is_held(&self) -> bool {
        !self.ends.is_free() && self.displacement == Vec3::ZERO
    }

    /// Returns true if the wedges of `v0` keep their values: it stays where it is, or moves along
    /// the surface's normal only.
    #[inline(always)]
    pub(crate) fn keeps_values(&self) -> bool {
        self.displacement == Vec3::ZERO || !self.ends.is_free()
    }
}

/// Slots that meet along an edge, each pair from `v0` and `v1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct WedgePairs {
    /// Slots of `v0` and of `v1` on the two sides of the edge.
    pub(crate) sides: [WedgeSides; 2],
    pub(crate) pairs: [[u32; 2]; 2],
    /// True if the second pair differs from the first.
    pub(crate) are_two: bool,
    /// True for an end that has slots in no pair.
    pub(crate) has_unpaired: [bool; 2],
}

impl WedgePairs {
    /// Returns the pair of two vertices away from seams, whose slots are their ids.
    #[inline(always)]
    pub(crate) fn smooth(v0: u32, v1: u32) -> Self {
        let sides = [WedgeSides { before: v0, after: v0 }, WedgeSides { before: v1, after: v1 }];
        Self { sides, pairs: [[v0, v1]; 2], are_two: false, has_unpaired: [false; 2] }
    }

    /// Pairs the slots on either side of the edge. A side without a face has the slots of the other
    /// side.
    #[inline(always)]
    pub(crate) fn new(at0: WedgeSides, at1: WedgeSides, has_unpaired: [bool; 2]) -> Self {
        let pairs = [[at0.after, at1.before], [at0.before, at1.after]];
        Self { sides: [at0, at1], pairs, are_two: pairs[0] != pairs[1], has_unpaired }
    }

    /// Returns the pairs: one, or one for each side.
    #[inline(always)]
    pub(crate) fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs[..1 + usize::from(self.are_two)]
    }

    /// Returns the pair of the second side if it differs from the first.
    #[inline(always)]
    pub(crate) fn other(&self) -> Option<[u32; 2]> {
        self.are_two.then_some(self.pairs[1])
    }

    /// Returns true if a slot of an end is in no pair.
    #[inline(always)]
    pub(crate) fn is_unpaired(&self, end: usize, slot: u32) -> bool {
        slot != self.pairs[0][end] && !(self.are_two && slot == self.pairs[1][end])
    }

    /// Swaps the two ends.
    #[inline(always)]
    pub(crate) fn turned(&self) -> Self {
        let ([at0, at1], [of_v0, of_v1]) = (self.sides, self.has_unpaired);
        Self::new(at1, at0, [of_v1, of_v0])
    }
}

/// Slots of a vertex in the two faces at one of its edges, in counter-clockwise order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct WedgeSides {
    /// Slot in the face that ends at the neighbour.
    pub(crate) before: u32,
    /// Slot in the face that begins at the neighbour.
    pub(crate) after: u32,
}
