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
use crate::fast::cost::{self, Edges};
use crate::fast::dress::Corners;
use crate::fast::field::{All, Each, Field, join, join_one};
use crate::fast::hood::Hood;
use crate::fast::looks::{Ends, Looks, Placed, Revalued, by_pins};
use crate::fast::place::Swept;
use crate::fast::ring::{GHOST, Vertices};
use crate::fast::seams::Seams;
use crate::fast::vertex::{Flags, Star};
use crate::fast::wide::LANES;
use crate::refusal::Refusal;

/// All wedges of a surface.
pub(super) struct Painted<'m, const K: usize> {
    /// By slot.
    pub(super) fields: Vec<Field<K>>,
    /// By slot: the one that it has become part of; itself if it has new values, `NOBODY` if it has
    /// those of the input.
    pub(super) heirs: Vec<u32>,
    pub(super) seams: Seams,
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
    pub(super) fn pairs(&self, vertices: &Vertices, Ends { v0, v1, .. }: Ends) -> Pairs {
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

    /// Whether the wedges of `v` all have one at `onto` to go to.
    fn may_leave(&self, vertices: &Vertices, v: u32, onto: u32) -> bool {
        if vertices.get(v).flags.any(Flags::PINNED) {
            return false;
        }
        let sectors = self.seams.of(v);
        match sectors.len() {
            0 | 1 => !self.seams.parts(onto, v),
            2 => {
                let along = sectors.iter().any(|sector| sector.from == onto);
                along && !vertices.settled(v).contains(&GHOST)
            }
            _ => false,
        }
    }
}

impl<const K: usize> Looks for Painted<'_, K> {
    const IN_PARTS: bool = false;

    fn side_by_side(self, _: usize) -> Vec<Self> {
        vec![self]
    }

    #[inline(always)]
    fn join(&self, us: cost::Ends<'_>, vs: &[u32; LANES], edges: &mut Edges) {
        let of = |ids: &[u32; LANES]| {
            let of = |lane: usize| self.field(ids[lane]);
            [of(0), of(1), of(2), of(3), of(4), of(5), of(6), of(7)]
        };
        match us {
            cost::Ends::Of(u) => join(&All(self.field(u)), &Each(of(vs)), edges),
            cost::Ends::Each(us) => join(&Each(of(us)), &Each(of(vs)), edges),
        }
    }

    #[inline(always)]
    fn order(&self, vertices: &Vertices, v: u32, target: u32) -> Result<Ends, Refusal> {
        if !is_seam(vertices, v) && !is_seam(vertices, target) {
            return by_pins(vertices, v, target);
        }
        let leaves = self.may_leave(vertices, v, target);
        let goes = self.may_leave(vertices, target, v);
        match (leaves, goes) {
            (true, true) => Ok(Ends { v0: v, v1: target, free: true }),
            (true, false) => Ok(Ends { v0: target, v1: v, free: false }),
            (false, true) => Ok(Ends { v0: v, v1: target, free: false }),
            (false, false) => Err(Refusal::Seam),
        }
    }

    #[inline(always)]
    fn whole(&self, vertices: &Vertices, ends: Ends, mut swept: Swept) -> Swept {
        for &[s0, s1] in self.pairs(vertices, ends).all() {
            join_one(&mut swept, self.field(s0), self.field(s1));
        }
        swept
    }

    fn onto(&self, vertices: &Vertices, ends: Ends) -> f32 {
        let by = vertices.get(ends.v0).place() - vertices.get(ends.v1).place();
        let pairs = self.pairs(vertices, ends);
        pairs.all().iter().map(|&[s0, s1]| self.field(s1).onto(by, self.field(s0))).sum()
    }

    #[inline(always)]
    fn contract(&mut self, vertices: &mut Vertices, hood: &Hood, placed: &Placed) -> Star {
        let Ends { v0, v1, .. } = placed.ends;
        let any = |v: &u32| is_seam(vertices, *v);
        if any(&v0) || any(&v1) || hood.ids().iter().any(any) {
            return self.contract_by_slots(vertices, hood, placed);
        }
        if self.coat.has_rest() {
            let slots = Slots::new(&self.seams, vertices, hood, placed.ends);
            let pairs = self.pairs(vertices, placed.ends);
            self.move_rest(hood, placed, (&slots, &pairs));
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
