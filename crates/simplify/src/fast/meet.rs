//! Which wedges of two vertices meet along their edge, and which of the two goes into the other.

use crate::fast::looks::{Ends, by_pins};
use crate::fast::painted::{Painted, is_seam};
use crate::fast::ring::Vertices;
use crate::fast::seams::{Sector, Sides};
use crate::fast::vertex::Flags;
use crate::refusal::Refusal;

/// The slots that meet along an edge, of `v0` and of `v1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Meeting {
    /// On each side of the edge, as seen from `v0` and from `v1`.
    pub(super) sides: [Sides; 2],
    pairs: [[u32; 2]; 2],
    /// Whether the second pair is another than the first.
    are_two: bool,
    /// Whether an end has slots that are in no pair.
    pub(super) has_alone: [bool; 2],
}

impl Meeting {
    /// Where vertices are slots.
    #[inline(always)]
    pub(super) fn smooth(v0: u32, v1: u32) -> Self {
        let sides = [Sides { before: v0, after: v0 }, Sides { before: v1, after: v1 }];
        Self { sides, pairs: [[v0, v1]; 2], are_two: false, has_alone: [false; 2] }
    }

    /// Where one side has no face, it has the slots of the other.
    #[inline(always)]
    fn new(at0: Sides, at1: Sides, has_alone: [bool; 2]) -> Self {
        let pairs = [[at0.after, at1.before], [at0.before, at1.after]];
        Self { sides: [at0, at1], pairs, are_two: pairs[0] != pairs[1], has_alone }
    }

    /// One pair, or one on each side.
    #[inline(always)]
    pub(super) fn pairs(&self) -> &[[u32; 2]] {
        &self.pairs[..1 + usize::from(self.are_two)]
    }

    /// The pair of the other side, if it is another.
    #[inline(always)]
    pub(super) fn other(&self) -> Option<[u32; 2]> {
        self.are_two.then_some(self.pairs[1])
    }

    /// Whether a slot of an end is in no pair.
    #[inline(always)]
    fn is_alone(&self, end: usize, slot: u32) -> bool {
        slot != self.pairs[0][end] && !(self.are_two && slot == self.pairs[1][end])
    }

    /// As seen from the other end.
    #[inline(always)]
    fn turned(&self) -> Self {
        let ([at0, at1], [of_v0, of_v1]) = (self.sides, self.has_alone);
        Self::new(at1, at0, [of_v1, of_v0])
    }
}

impl<const K: usize> Painted<'_, K> {
    /// Which end of an edge goes into which, and what meets.
    #[inline(always)]
    pub(super) fn ends(&self, vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal> {
        if !is_seam(vertices, v) && !is_seam(vertices, target) {
            return by_pins(vertices, v, target);
        }
        let at0 = self.seams.sides(vertices, v, target);
        let at1 = self.seams.sides(vertices, target, v);
        let mut met = Meeting::new(at0, at1, [false; 2]);
        let leaves = self.may_leave(vertices, &mut met, (0, v));
        let goes = self.may_leave(vertices, &mut met, (1, target));
        if !leaves && !goes {
            return Err(Refusal::Seam);
        }
        // Where two of one end meet one of the other not all may be one: that other end goes.
        let [[a, _], [b, _]] = met.pairs;
        let one_meets_two = met.are_two && a == b;
        let turns = if leaves && goes { one_meets_two } else { leaves };
        let (v0, v1) = if turns { (target, v) } else { (v, target) };
        let met = if turns { met.turned() } else { met };
        Ok(Ends { v0, v1, free: leaves && goes, met: self.one_each(met) })
    }

    /// One of `v1` that meets two goes into that of the lower wedge.
    #[inline(always)]
    fn one_each(&self, mut met: Meeting) -> Meeting {
        let [[a, s], [b, t]] = met.pairs;
        if met.are_two && s == t {
            let [first, second] = [self.corners.wedge(a), self.corners.wedge(b)];
            met.pairs[0][0] = if first <= second { a } else { b };
            met.are_two = false;
            met.has_alone[0] = !self.charts.is_empty();
        }
        met
    }

    /// Whether the charts of an end of an edge all have one at the other end to go to, and only one.
    /// Takes down whether it has slots that meet none.
    #[inline(always)]
    fn may_leave(&self, vertices: &Vertices, met: &mut Meeting, (end, v): (usize, u32)) -> bool {
        let [[a, s], [b, t]] = met.pairs;
        let (own, other) = if end == 0 { ([a, b], [s, t]) } else { ([s, t], [a, b]) };
        let [first, second] = [self.chart(own[0]), self.chart(own[1])];
        let parts = || self.chart(other[0]) != self.chart(other[1]);
        let (mut all_go, mut any_alone) = (true, false);
        for sector in self.seams.of(v) {
            if met.is_alone(end, sector.slot) {
                let chart = self.chart(sector.slot);
                all_go &= (chart == first) | (chart == second);
                any_alone = true;
            }
        }
        met.has_alone[end] = any_alone & !self.charts.is_empty();
        all_go && !(first == second && parts()) && !vertices.get(v).flags.any(Flags::PINNED)
    }

    /// The slots of an end that do not meet any along the edge. They stay with their faces.
    #[inline(always)]
    pub(super) fn alone(&self, ends: &Ends, end: usize) -> impl Iterator<Item = u32> + '_ {
        let (v, met) = ([ends.v0, ends.v1][end], ends.met);
        let sectors = if met.has_alone[end] { self.seams.of(v) } else { &[] };
        let first = move |(i, sector): (usize, &Sector)| {
            let is_first = || sectors[..i].iter().all(|other| other.slot != sector.slot);
            (met.is_alone(end, sector.slot) && is_first()).then_some(sector.slot)
        };
        sectors.iter().enumerate().filter_map(first)
    }

    /// The slot of `v0` whose chart that of a slot of `v1` becomes.
    pub(super) fn leader(&self, met: &Meeting, slot: u32) -> u32 {
        let chart = self.chart(slot);
        let found = met.pairs().iter().find(|pair| self.chart(pair[1]) == chart);
        found.map_or(slot, |pair| pair[0])
    }
}
