//! Attributes in the fast engine: a field at each wedge, beside the vertices.
//!
//! A wedge is known by its slot: a vertex's first has the vertex's own number, the others follow after
//! all of these. So a mesh without seams asks nobody which wedge it is.
//!
//! Seams are contracted along themselves, both sides at once; a vertex that has no seam goes into one
//! that has, which stays where it is. So do the ends of seams, and where several meet.

use meshlod_mesh::Attributes;

use crate::fast::around::Slots;
use crate::fast::carry::Scratch;
use crate::fast::coat::Coat;
use crate::fast::cost::{Edges, Side};
use crate::fast::dress::Corners;
use crate::fast::field::{Field, join, join_alone, join_one};
use crate::fast::hood::Hood;
use crate::fast::looks::{Ends, Looks, Placed, Revalued, by_pins};
use crate::fast::memoryless::Memoryless;
use crate::fast::place::Swept;
use crate::fast::ring::Vertices;
use crate::fast::seams::Seams;
use crate::fast::vertex::{Flags, Star};
use crate::refusal::Refusal;

/// All wedges of a surface.
pub(super) struct Painted<'m, const K: usize> {
    /// By slot.
    pub(super) fields: Vec<Field<K>>,
    /// By slot: the one that it has become part of; itself if it has new values, `NOBODY` if it has
    /// those of the input.
    pub(super) heirs: Vec<u32>,
    pub(super) seams: Seams,
    /// By slot: the chart that it is of, see [`Painted::chart`]; empty where each is its own.
    pub(super) charts: Vec<u32>,
    pub(super) coat: Coat<'m>,
    pub(super) corners: Corners<'m>,
    pub(super) scratch: Box<Scratch<K>>,
    /// The values that contractions gave, where that is wanted.
    pub(super) record: Vec<Revalued>,
    /// How many contractions have been logged.
    pub(super) logged: usize,
    /// What is at no wedge.
    pub(super) none: Field<K>,
}

/// The slots that meet along an edge, of `v0` and of `v1`: one pair, or one on each side.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pairs {
    pairs: [[u32; 2]; 2],
    len: usize,
}

impl Pairs {
    fn add(&mut self, pair: [u32; 2]) {
        if !self.all().contains(&pair) {
            self.pairs[self.len] = pair;
            self.len += 1;
        }
    }

    pub(super) fn all(&self) -> &[[u32; 2]] {
        &self.pairs[..self.len]
    }
}

impl<const K: usize> Painted<'_, K> {
    #[inline(always)]
    pub(super) fn field(&self, slot: u32) -> &Field<K> {
        self.fields.get(slot as usize).unwrap_or(&self.none)
    }

    /// The slots that meet along an edge.
    fn meeting(&self, vertices: &Vertices, Ends { v0, v1, .. }: Ends) -> Pairs {
        let mut pairs = Pairs::default();
        if !is_seam(vertices, v0) && !is_seam(vertices, v1) {
            pairs.add([v0, v1]);
            return pairs;
        }
        // Where one side has no face, it has the slots of the other.
        let (at0, at1) = (self.seams.sides(vertices, v0, v1), self.seams.sides(vertices, v1, v0));
        pairs.add([at0.after, at1.before]);
        pairs.add([at0.before, at1.after]);
        pairs
    }

    /// The slots that become one. One of `v1` that meets two goes into that of the lower wedge.
    pub(super) fn pairs(&self, vertices: &Vertices, ends: Ends) -> Pairs {
        let mut pairs = self.meeting(vertices, ends);
        if let [[a, s], [b, t]] = *pairs.all()
            && s == t
        {
            let [first, second] = [a, b].map(|slot| self.corners.wedge(slot));
            pairs = Pairs::default();
            pairs.add([if first <= second { a } else { b }, s]);
        }
        pairs
    }

    /// What the slots of one vertex have in common that differ in normals and tangents alone: their
    /// place in the textures. A cut between charts stays; a crease in the shading is no obstacle.
    #[inline]
    pub(super) fn chart(&self, slot: u32) -> u32 {
        self.charts.get(slot as usize).copied().unwrap_or(slot)
    }

    /// Whether the charts of an end of an edge all have one at the other end to go to.
    fn may_leave(&self, vertices: &Vertices, pairs: &Pairs, (end, v): (usize, u32)) -> bool {
        if vertices.get(v).flags.any(Flags::PINNED) {
            return false;
        }
        let pairs = pairs.all();
        let chart_at = |pair: &[u32; 2], end: usize| self.chart(pair[end]);
        let goes = |slot: u32| {
            let mut met = pairs.iter().filter(|pair| chart_at(pair, end) == self.chart(slot));
            let first = met.next().map(|pair| chart_at(pair, 1 - end));
            first.is_some_and(|first| met.all(|pair| chart_at(pair, 1 - end) == first))
        };
        self.seams.slots(v).all(goes)
    }

    /// The slots of an end that do not meet any along the edge. They stay with their faces.
    pub(super) fn alone<'a>(
        &'a self,
        pairs: &'a Pairs,
        (end, v): (usize, u32),
    ) -> impl Iterator<Item = u32> + 'a {
        let count = if self.charts.is_empty() { 0 } else { usize::MAX };
        let is_alone = move |slot: &u32| pairs.all().iter().all(|pair| pair[end] != *slot);
        self.seams.slots(v).take(count).filter(is_alone)
    }

    /// The slot of `v0` whose chart that of a slot of `v1` becomes.
    pub(super) fn leader(&self, pairs: &Pairs, slot: u32) -> u32 {
        let chart = self.chart(slot);
        let met = pairs.all().iter().find(|pair| self.chart(pair[1]) == chart);
        met.map_or(slot, |pair| pair[0])
    }
}

impl<const K: usize> Looks for Painted<'_, K> {
    type Rule = Memoryless;

    const IN_PARTS: bool = false;

    fn side_by_side(self, _: usize) -> Vec<Self> {
        vec![self]
    }

    #[inline(always)]
    fn join(&self, sides: [Side<u32>; 2], edges: &mut Edges) {
        join(sides, |slot| self.field(slot), edges);
    }

    #[inline(always)]
    fn order(&self, vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal> {
        if !is_seam(vertices, v) && !is_seam(vertices, target) {
            return by_pins(vertices, v, target);
        }
        let pairs = self.meeting(vertices, Ends { v0: v, v1: target, free: true });
        let leaves = self.may_leave(vertices, &pairs, (0, v));
        let goes = self.may_leave(vertices, &pairs, (1, target));
        match (leaves, goes) {
            (true, true) => Ok(Ends { v0: v, v1: target, free: true }),
            (true, false) => Ok(Ends { v0: target, v1: v, free: false }),
            (false, true) => Ok(Ends { v0: v, v1: target, free: false }),
            (false, false) => Err(Refusal::Seam),
        }
    }

    #[inline(always)]
    fn whole(&self, vertices: &Vertices, ends: Ends, mut swept: Swept) -> Swept {
        let pairs = self.pairs(vertices, ends);
        for &[s0, s1] in pairs.all() {
            join_one(&mut swept, self.field(s0), self.field(s1));
        }
        let half = swept.half;
        for (end, v, from) in [(0, ends.v0, -half), (1, ends.v1, half)] {
            for slot in self.alone(&pairs, (end, v)) {
                join_alone(&mut swept, self.field(slot), from);
            }
        }
        swept
    }

    fn onto(&self, vertices: &Vertices, ends: Ends) -> f32 {
        let by = vertices.get(ends.v0).place() - vertices.get(ends.v1).place();
        let pairs = self.pairs(vertices, ends);
        let to = |&[s0, s1]: &[u32; 2]| self.field(s1).onto(by, &self.field(s0).values());
        let alone = self.alone(&pairs, (1, ends.v1)).map(|slot| {
            let field = self.field(slot);
            let mut values = field.best_values(by.as_dvec3());
            self.coat.follow(&mut values, &self.field(self.leader(&pairs, slot)).values());
            field.onto(by, &values)
        });
        pairs.all().iter().map(to).chain(alone).sum()
    }

    #[inline(always)]
    fn look_ahead(&mut self, vertices: &Vertices, hood: &Hood, placed: &Placed) -> bool {
        match self.has_seam(vertices, hood, placed.ends) {
            true => self.look_ahead_by_slots(vertices, hood, placed),
            false => self.look_ahead_smooth(hood, placed),
        }
    }

    #[inline(always)]
    fn contract(&mut self, vertices: &mut Vertices, hood: &Hood, placed: &Placed) -> Star {
        if self.has_seam(vertices, hood, placed.ends) {
            return self.contract_by_slots(vertices, hood, placed);
        }
        if self.coat.has_rest() {
            let pairs = self.pairs(vertices, placed.ends);
            let slots = Slots::new(&self.seams, vertices, hood, (placed.ends, pairs));
            self.move_rest(hood, placed, &slots);
        }
        self.contract_smooth(hood, placed);
        Star::default()
    }

    #[inline(always)]
    fn warm(&self, v: u32) -> u32 {
        let field = self.field(v);
        field.squares[0].x.to_bits() ^ field.channels.last().map_or(0, |last| last.w.to_bits())
    }

    fn attributes(&self, faces: impl Iterator<Item = (u32, [u32; 3])>) -> Option<Attributes> {
        self.corners.are_given.then(|| self.undress(faces))
    }

    fn all_attributes(&self, faces: impl Iterator<Item = [u32; 3]>) -> Option<Attributes> {
        self.corners.are_given.then(|| self.undress_all(faces))
    }

    fn record(&mut self, vertex: u32) {
        if self.corners.are_given {
            self.take_down(vertex);
        }
        self.logged += 1;
    }

    fn recorded(&mut self) -> Vec<Revalued> {
        self.logged = 0;
        std::mem::take(&mut self.record)
    }
}

#[inline(always)]
pub(super) fn is_seam(vertices: &Vertices, v: u32) -> bool {
    vertices.get(v).flags.any(Flags::SEAM)
}
