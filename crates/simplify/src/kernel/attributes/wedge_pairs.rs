//! Pairing of the wedges along an edge, and the choice of the end that is contracted.

use crate::kernel::attributes::bare::by_pins;
use crate::kernel::attributes::seam_sectors::Sector;
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::collapse::{Ends, Mobility, WedgePairs};
use crate::kernel::mesh::one_ring::{Vertices, is_seam};
use crate::kernel::metric::Metric;
use crate::refusal::Refusal;

impl<M: Metric, const K: usize> WedgeQuadrics<'_, M, K> {
    /// Decides which end of an edge is contracted into which, and pairs their slots.
    #[inline(always)]
    pub(crate) fn ends(&self, vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal> {
        if !is_seam(vertices, v) && !is_seam(vertices, target) {
            return by_pins(vertices, v, target);
        }
        let flags = [v, target].map(|v| vertices.get(v).flags);
        let at0 = self.seams.sides(vertices, v, target);
        let at1 = self.seams.sides(vertices, target, v);
        let mut wedge_pairs = WedgePairs::new(at0, at1, [false; 2]);
        let moves = [!flags[0].stays_beside(flags[1]), !flags[1].stays_beside(flags[0])];
        let leaves = self.may_leave(&mut wedge_pairs, (0, v)) && moves[0];
        let goes = self.may_leave(&mut wedge_pairs, (1, target)) && moves[1];
        if leaves || goes {
            return Ok(self.turned([v, target], wedge_pairs, [leaves, goes], moves));
        }
        if *self.seams_hold {
            return Err(Refusal::Seam);
        }
        self.ends_across_seams([v, target], wedge_pairs, moves)
    }

    /// Decides which end of an edge is contracted into which where seams give way. `moves` are the
    /// ends that no pin holds. Unpaired slots stay with their faces, each in its own chart.
    #[cold]
    fn ends_across_seams(
        &self,
        ends: [u32; 2],
        mut wedge_pairs: WedgePairs,
        moves: [bool; 2],
    ) -> Result<Ends, Refusal> {
        for end in 0..2 {
            let mut sectors = self.seams.of(ends[end]).iter();
            wedge_pairs.has_unpaired[end] =
                sectors.any(|sector| wedge_pairs.is_unpaired(end, sector.slot));
        }
        let [[a, s], [b, t]] = wedge_pairs.pairs;
        // The end of a cut stays, and both sides of the cut are contracted into it.
        let parts =
            [a == b && self.chart(s) != self.chart(t), s == t && self.chart(a) != self.chart(b)];
        let [leaves, goes] = match [moves[0] && !parts[0], moves[1] && !parts[1]] {
            [false, false] => moves,
            ways => ways,
        };
        if !leaves && !goes {
            return Err(Refusal::Seam);
        }
        Ok(Ends { cuts_seam: true, ..self.turned(ends, wedge_pairs, [leaves, goes], moves) })
    }

    /// Turns an edge such that an end that may go is contracted into the other. At least one may.
    /// `moves` are the ends that no pin holds.
    #[inline(always)]
    fn turned(
        &self,
        [v, target]: [u32; 2],
        wedge_pairs: WedgePairs,
        [leaves, goes]: [bool; 2],
        moves: [bool; 2],
    ) -> Ends {
        // Where two slots of one end meet one of the other, not all can become one: that other end
        // goes.
        let [[a, _], [b, _]] = wedge_pairs.pairs;
        let one_meets_two = wedge_pairs.are_two && a == b;
        let turns = if leaves && goes { one_meets_two } else { leaves };
        let (v0, v1) = if turns { (target, v) } else { (v, target) };
        let wedge_pairs = if turns { wedge_pairs.turned() } else { wedge_pairs };
        let wedge_pairs = self.one_each(wedge_pairs);
        let mobility = match moves[usize::from(turns)] {
            _ if leaves && goes => Mobility::Free,
            true if *self.seams_hold => Mobility::AlongNormal,
            true => Mobility::Leaning,
            false => Mobility::Fixed,
        };
        Ends { v0, v1, mobility, cuts_seam: false, wedge_pairs }
    }

    /// Resolves a slot of `v1` in two pairs: it is merged into the slot of the lower wedge.
    #[inline(always)]
    fn one_each(&self, mut wedge_pairs: WedgePairs) -> WedgePairs {
        let [[a, s], [b, t]] = wedge_pairs.pairs;
        if wedge_pairs.are_two && s == t {
            let [first, second] = [self.corners.wedge(a), self.corners.wedge(b)];
            wedge_pairs.pairs[0][0] = if first <= second { a } else { b };
            wedge_pairs.are_two = false;
            wedge_pairs.has_unpaired[0] |= !self.charts.is_empty();
        }
        wedge_pairs
    }

    /// Returns true if each chart of an end has exactly one chart at the other end to join. Also
    /// notes whether the end has unpaired slots.
    #[inline(always)]
    fn may_leave(&self, wedge_pairs: &mut WedgePairs, (end, v): (usize, u32)) -> bool {
        let [[a, s], [b, t]] = wedge_pairs.pairs;
        let (own, other) = if end == 0 { ([a, b], [s, t]) } else { ([s, t], [a, b]) };
        let [first, second] = [self.chart(own[0]), self.chart(own[1])];
        let parts = || self.chart(other[0]) != self.chart(other[1]);
        let (mut all_go, mut any_unpaired) = (true, false);
        for sector in self.seams.of(v) {
            if wedge_pairs.is_unpaired(end, sector.slot) {
                let chart = self.chart(sector.slot);
                all_go &= (chart == first) | (chart == second);
                any_unpaired = true;
            }
        }
        wedge_pairs.has_unpaired[end] = any_unpaired & !self.charts.is_empty();
        all_go && !(first == second && parts())
    }

    /// Returns the unpaired slots of an end, which stay with their faces.
    #[inline(always)]
    pub(crate) fn unpaired(&self, ends: &Ends, end: usize) -> impl Iterator<Item = u32> + '_ {
        let (v, wedge_pairs) = ([ends.v0, ends.v1][end], ends.wedge_pairs);
        let sectors = if wedge_pairs.has_unpaired[end] { self.seams.of(v) } else { &[] };
        let first = move |(i, sector): (usize, &Sector)| {
            let is_first = || sectors[..i].iter().all(|other| other.slot != sector.slot);
            (wedge_pairs.is_unpaired(end, sector.slot) && is_first()).then_some(sector.slot)
        };
        sectors.iter().enumerate().filter_map(first)
    }

    /// Returns the slot of `v0` whose chart a slot of `v1` joins.
    pub(crate) fn leader(&self, wedge_pairs: &WedgePairs, slot: u32) -> u32 {
        let chart = self.chart(slot);
        let found = wedge_pairs.pairs().iter().find(|pair| self.chart(pair[1]) == chart);
        found.map_or(slot, |pair| pair[0])
    }
}
