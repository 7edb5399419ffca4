//! Attributes in the fast engine: a field at each wedge, beside the vertices.
//!
//! A wedge is known by its slot: a vertex's first has the vertex's own number, the others follow after
//! all of these. So a mesh without seams asks nobody which wedge it is.
//!
//! Seams are contracted along themselves, both sides at once; a vertex that has no seam goes into one
//! that has, which stays where it is. So do the ends of seams, and where several meet.

use meshlod_mesh::Attributes;

use crate::fast::ahead::AheadBySlots;
use crate::fast::around::BySlots;
use crate::fast::carry::Scratch;
use crate::fast::coat::Coat;
use crate::fast::cost::{Costs, Edges, Side};
use crate::fast::dress::Corners;
use crate::fast::field::{Field, join, join_alone, join_one};
use crate::fast::hood::Hood;
use crate::fast::looks::{Ends, Looks, Placed, Revalued};
use crate::fast::memoryless::Memoryless;
use crate::fast::place::Swept;
use crate::fast::ring::Vertices;
use crate::fast::seams::Seams;
use crate::fast::vertex::{Flags, Star};
use crate::fast::wide::{LANES, widest};
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

impl<const K: usize> Painted<'_, K> {
    #[inline(always)]
    pub(super) fn field(&self, slot: u32) -> &Field<K> {
        self.fields.get(slot as usize).unwrap_or(&self.none)
    }

    /// What the slots of one vertex have in common that differ in normals and tangents alone: their
    /// place in the textures. A cut between charts stays; a crease in the shading is no obstacle.
    #[inline]
    pub(super) fn chart(&self, slot: u32) -> u32 {
        self.charts.get(slot as usize).copied().unwrap_or(slot)
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
        self.ends(vertices, v, target)
    }

    #[inline(always)]
    fn at_seams(&self, vertices: &Vertices, us: Side<u32>, vs: &[u32; LANES]) -> Option<Costs> {
        self.costs_at_seams(vertices, us, vs)
    }

    #[inline(always)]
    fn whole(&self, ends: &Ends, mut swept: Swept) -> Swept {
        for &[s0, s1] in ends.met.pairs() {
            join_one(&mut swept, self.field(s0), self.field(s1));
        }
        let half = swept.half;
        for (end, from) in [(0, -half), (1, half)] {
            for slot in self.alone(ends, end) {
                join_alone(&mut swept, self.field(slot), from);
            }
        }
        swept
    }

    fn onto(&self, vertices: &Vertices, ends: &Ends) -> f32 {
        let by = vertices.get(ends.v0).place() - vertices.get(ends.v1).place();
        let to = |&[s0, s1]: &[u32; 2]| self.field(s1).onto(by, &self.field(s0).values());
        ends.met.pairs().iter().map(to).sum::<f32>() + self.alone_onto(ends, by)
    }

    #[inline(always)]
    fn look_ahead(&mut self, vertices: &Vertices, hood: &Hood, placed: &Placed) -> bool {
        match self.has_seam(vertices, hood, placed.ends) {
            true => widest(AheadBySlots { painted: self, vertices, hood, placed }),
            false => self.look_ahead_smooth(hood, placed),
        }
    }

    #[inline(always)]
    fn contract(&mut self, vertices: &mut Vertices, hood: &Hood, placed: &Placed) -> Star {
        if self.has_seam(vertices, hood, placed.ends) {
            return widest(BySlots { painted: self, vertices, hood, placed });
        }
        self.move_rest(hood, placed, None);
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
