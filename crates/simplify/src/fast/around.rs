//! Contractions where seams are: every face asks which wedges it has.

use glam::Vec3;

use crate::fast::carry::dying;
use crate::fast::engine::SEAM_WEIGHT;
use crate::fast::field::Field;
use crate::fast::hood::Hood;
use crate::fast::looks::{Ends, Placed};
use crate::fast::meet::Meeting;
use crate::fast::painted::{Painted, is_seam};
use crate::fast::ring::{GHOST, Vertices};
use crate::fast::seams::Seams;
use crate::fast::vertex::{Flags, Star};
use crate::fast::wide::Work;

/// The slots of the faces around an edge. Of spoke i, those of its apex, of `ids[i]` and `ids[i + 1]`.
#[derive(Debug, Default)]
pub(super) struct Slots {
    pub(super) spokes: Vec<[u32; 3]>,
    /// Of the two faces that go: `v0`'s, `v1`'s and the wing's.
    pub(super) dying: [[u32; 3]; 2],
    /// Those of the new vertex in each spoke.
    pub(super) apexes: Vec<u32>,
}

impl Slots {
    /// Of the spokes, then of the faces that go.
    pub(super) fn face(&self, i: usize) -> [u32; 3] {
        let len = self.spokes.len();
        if i < len { self.spokes[i] } else { self.dying[i - len] }
    }

    /// Finds them.
    #[inline(always)]
    pub(super) fn find(&mut self, seams: &Seams, vertices: &Vertices, hood: &Hood, ends: &Ends) {
        let Ends { v0, v1, met, .. } = ends;
        let (v0, v1, [at0, at1]) = (*v0, *v1, met.sides);
        let ends_are_seams = [is_seam(vertices, v0), is_seam(vertices, v1)];
        let Self { spokes, dying, .. } = self;
        spokes.clear();
        spokes.resize(hood.len, [0; 3]);
        // Around both ends the ring begins with a wing, after the face that goes.
        let mut slot = at0.after;
        for (i, (spoke, &w)) in spokes.iter_mut().zip(hood.ids()).enumerate() {
            let apex = if i < hood.of_v0 { v0 } else { v1 };
            if i == hood.of_v0 {
                slot = at1.after;
            }
            if ends_are_seams[usize::from(i >= hood.of_v0)] {
                slot = seams.next(apex, w, slot);
            }
            spoke[0] = slot;
        }
        let wings = [hood.ids[0], hood.ids[hood.of_v0]];
        *dying = [[at0.after, at1.before, wings[0]], [at0.before, at1.after, wings[1]]];
        for i in 0..hood.len {
            let (w, before) = (hood.ids[i], if i == 0 { hood.len - 1 } else { i - 1 });
            let apexes = [before, i].map(|i| if i < hood.of_v0 { v0 } else { v1 });
            if !is_seam(vertices, w) {
                (spokes[before][2], spokes[i][1]) = (w, w);
                continue;
            }
            let last = seams.sides(vertices, w, apexes[1]);
            let first = match apexes[0] == apexes[1] {
                true => last,
                false => seams.sides(vertices, w, apexes[0]),
            };
            let sides = [first, last];
            (spokes[before][2], spokes[i][1]) = (sides[0].after, sides[1].before);
            if i == 0 {
                dying[0][2] = sides[1].after;
            } else if i == hood.of_v0 {
                dying[1][2] = sides[1].after;
            }
        }
        self.find_apexes(hood, met);
    }

    fn find_apexes(&mut self, hood: &Hood, met: &Meeting) {
        let Self { spokes, apexes, .. } = self;
        apexes.clear();
        apexes.resize(hood.len, 0);
        for (i, apex) in apexes.iter_mut().enumerate() {
            *apex = spokes[i][0];
            if i >= hood.of_v0 {
                let pair = met.pairs().iter().find(|pair| pair[1] == *apex);
                *apex = pair.map_or(*apex, |pair| pair[0]);
            }
        }
        // The ghost's faces go with those beside them.
        if let Some(ghost) = hood.ghost {
            let at = |i: usize| (ghost + hood.len + i) % hood.len;
            apexes[at(hood.len - 1)] = apexes[at(hood.len - 2)];
            apexes[ghost] = apexes[at(1)];
        }
    }
}

/// A contraction where something around has a seam, see [`Painted::contract_by_slots`].
pub(super) struct BySlots<'a, 'm, 'v, const K: usize> {
    pub(super) painted: &'a mut Painted<'m, K>,
    pub(super) vertices: &'a mut Vertices<'v>,
    pub(super) hood: &'a Hood,
    pub(super) placed: &'a Placed,
}

impl<const K: usize> Work for BySlots<'_, '_, '_, K> {
    type Output = Star;

    #[inline(always)]
    fn work(self) -> Star {
        self.painted.contract_by_slots(self.vertices, self.hood, self.placed)
    }
}

impl<const K: usize> Painted<'_, K> {
    /// Where something around has a seam. Gives what the new star has of seams.
    #[inline(always)]
    fn contract_by_slots(&mut self, vertices: &mut Vertices, hood: &Hood, placed: &Placed) -> Star {
        let Ends { v0, v1, met, .. } = placed.ends;
        let slots = std::mem::take(&mut self.scratch.slots);
        self.move_rest(hood, placed, Some(&slots));
        self.take_fences(vertices, hood, placed);
        self.join_charts(&met);
        let fence = self.put_fences(vertices, hood, placed, &slots);
        self.renew_fields(hood, placed, &slots);
        for &[s0, s1] in met.pairs() {
            self.heirs[s1 as usize] = s0;
        }
        for renewed in &self.scratch.renewed {
            self.heirs[renewed.slot as usize] = renewed.slot;
        }
        self.renew_sectors(vertices, hood, [v0, v1], &slots.apexes);
        self.scratch.slots = slots;
        fence
    }

    /// Brings up to date what the faces that change have added to all fields around.
    #[inline(always)]
    fn renew_fields(&mut self, hood: &Hood, placed: &Placed, slots: &Slots) {
        let Self { fields, scratch, .. } = self;
        let apexes = &slots.apexes;
        scratch.change::<true>(hood, placed.by, [&[0.0; K]; 3]);
        for (wing, of) in [0, hood.of_v0].into_iter().zip(slots.dying) {
            if hood.ghost != Some(wing) {
                let [v0, v1, other] = of.map(|slot| fields[slot as usize].values());
                fields[of[2] as usize].take(&dying(hood, wing, [&v0, &v1, &other]));
            }
        }
        for (i, &slot) in apexes.iter().enumerate() {
            if i > 0 && slot == apexes[i - 1] {
                continue;
            }
            let mut values = [0.0; K];
            for (value, row) in values.iter_mut().zip(&scratch.after) {
                *value = row[i];
            }
            fields[slot as usize] = Field::of_values(values);
        }
        for i in (0..hood.len).filter(|&i| hood.is_face(i)) {
            let [_, a, b] = slots.spokes[i];
            fields[a as usize].add(&scratch.changes[i]);
            fields[b as usize].add(&scratch.changes[i]);
            fields[apexes[i] as usize].add(&scratch.new[i]);
        }
    }

    /// Takes the squares of cuts that change out of the stars around.
    fn take_fences(&self, vertices: &mut Vertices, hood: &Hood, placed: &Placed) {
        let Ends { v0, v1, .. } = placed.ends;
        let any = is_seam(vertices, v0) || is_seam(vertices, v1);
        for i in (0..hood.len).filter(|&i| hood.ghost != Some(i)) {
            let w = hood.ids[i];
            if !any && !is_seam(vertices, w) {
                continue;
            }
            let near = [i <= hood.of_v0, i >= hood.of_v0 || i == 0];
            for (apex, at, near) in [(v0, Vec3::ZERO, near[0]), (v1, hood.along, near[1])] {
                if near && self.is_cut_edge(apex, w) {
                    let fence = Star::boundary(hood.seen(i) - at, SEAM_WEIGHT);
                    vertices.get_mut(w).seen.take(&fence);
                }
            }
        }
    }

    /// Puts what they become in; gives what the new vertex has of them.
    fn put_fences(
        &self,
        vertices: &mut Vertices,
        hood: &Hood,
        placed: &Placed,
        slots: &Slots,
    ) -> Star {
        let apexes = &slots.apexes;
        let mut sum = Star::default();
        let differ = |a: u32, b: u32| a != b && self.chart(a) != self.chart(b);
        for i in (0..hood.len).filter(|&i| hood.is_face(i)) {
            let before = (i + hood.len - 1) % hood.len;
            let (last, first) = (slots.spokes[before][2], slots.spokes[i][1]);
            if hood.is_face(before) && (differ(apexes[before], apexes[i]) || differ(last, first)) {
                let fence = Star::boundary(hood.seen(i) - placed.by, SEAM_WEIGHT);
                vertices.get_mut(hood.ids[i]).seen.add(&fence);
                sum.add(&fence);
            }
        }
        sum
    }

    /// Whether charts differ across an edge, at this end.
    pub(super) fn is_cut(&self, v: u32, w: u32) -> bool {
        self.seams.parted(v, w).is_some_and(|[a, b]| self.chart(a) != self.chart(b))
    }

    fn is_cut_edge(&self, v: u32, w: u32) -> bool {
        self.is_cut(v, w) || self.is_cut(w, v)
    }

    fn renew_sectors(
        &mut self,
        vertices: &mut Vertices,
        hood: &Hood,
        [v0, v1]: [u32; 2],
        apexes: &[u32],
    ) {
        for (i, &w) in hood.ids().iter().enumerate() {
            if w == GHOST || !is_seam(vertices, w) {
                continue;
            }
            let first = match i {
                0 => Some(v0),
                i if i == hood.of_v0 => Some(v1),
                _ => None,
            };
            if !self.seams.rename(w, v1, v0, first) {
                vertices.get_mut(w).flags.clear(Flags::SEAM);
            }
        }
        if is_seam(vertices, v0) || is_seam(vertices, v1) {
            let any = self.seams.set(v0, (hood.ids(), apexes), vertices.all.len());
            let flags = &mut vertices.get_mut(v0).flags;
            if any { flags.set(Flags::SEAM) } else { flags.clear(Flags::SEAM) }
        }
    }
}
