//! Wedges from the corners of faces, and back.

use std::borrow::Cow;

use meshlod_mesh::{Attributes, Layer, Mesh, WedgeId};
use rustc_hash::FxHashMap;

use crate::fast::carry::Scratch;
use crate::fast::coat::{Coat, Left};
use crate::fast::engine::SEAM_WEIGHT;
use crate::fast::field::Field;
use crate::fast::looks::Revalued;
use crate::fast::painted::Painted;
use crate::fast::ring::{GHOST, Vertices};
use crate::fast::seams::Seams;
use crate::fast::vertex::{Flags, NOBODY, Star};
use crate::wedges::labels;

/// The wedges at the corners of a mesh, split further where the material changes or the object.
pub(super) struct Corners<'m> {
    of_face: Cow<'m, [[WedgeId; 3]]>,
    /// The wedges of the input that those after its own are of, and how many it has.
    split: Vec<u32>,
    own: usize,
    /// The material and object of each wedge, where there are several.
    labels: Vec<u32>,
    /// By vertex: its first wedge.
    first: Vec<u32>,
    /// Whether the mesh has attributes, or there are wedges for its labels alone.
    pub(super) are_given: bool,
    /// The other wedges that vertices have, in order; their slots follow those of vertices.
    others: Vec<(u32, u32)>,
}

impl<'m> Corners<'m> {
    /// `None` if there is nothing that could differ at a vertex. `faces` are those of the mesh, on
    /// copies of vertices where it has them, of `vertices` in all.
    pub(super) fn new(
        mesh: &'m Mesh,
        faces: impl Iterator<Item = [u32; 3]>,
        vertices: usize,
    ) -> Option<Self> {
        let labels = labels(mesh);
        let (of_face, own) = match &mesh.attributes {
            Some(all) => (Cow::Borrowed(&all.corners[..]), all.wedge_count),
            None if labels.is_some() => {
                let corners = mesh.faces.iter().map(|face| face.map(|v| WedgeId(v.0))).collect();
                (Cow::Owned(corners), mesh.positions.len())
            }
            None => return None,
        };
        let mut corners = Self {
            of_face,
            split: Vec::new(),
            own,
            labels: Vec::new(),
            are_given: mesh.attributes.is_some(),
            first: vec![NOBODY; vertices],
            others: Vec::new(),
        };
        if let Some(labels) = labels {
            corners.split_by(&labels);
        }
        corners.find(faces);
        Some(corners)
    }

    /// Gives each label wedges of its own; the first label to use one keeps it.
    fn split_by(&mut self, labels: &[u32]) {
        self.labels = vec![u32::MAX; self.own];
        let mut copies = FxHashMap::default();
        for (wedges, &label) in self.of_face.to_mut().iter_mut().zip(labels) {
            for wedge in wedges {
                let owner = &mut self.labels[wedge.index()];
                if *owner == u32::MAX {
                    *owner = label;
                }
                if *owner != label {
                    let next = (self.own + self.split.len()) as u32;
                    let copy = *copies.entry((wedge.0, label)).or_insert(next);
                    if copy == next {
                        self.split.push(wedge.0);
                        self.labels.push(label);
                    }
                    wedge.0 = copy;
                }
            }
        }
    }

    fn find(&mut self, faces: impl Iterator<Item = [u32; 3]>) {
        for (face, wedges) in faces.zip(&*self.of_face).filter(|(face, _)| is_face(*face)) {
            for (v, wedge) in face.into_iter().zip(wedges) {
                let first = &mut self.first[v as usize];
                if *first == NOBODY {
                    *first = wedge.0;
                } else if *first != wedge.0 {
                    self.others.push((v, wedge.0));
                }
            }
        }
        self.others.sort_unstable();
        self.others.dedup();
    }

    /// The slot of a wedge at a vertex.
    #[inline]
    fn slot(&self, v: u32, wedge: WedgeId) -> u32 {
        if self.first[v as usize] == wedge.0 {
            return v;
        }
        let found = self.others.binary_search(&(v, wedge.0)).unwrap_or_default();
        (self.first.len() + found) as u32
    }

    /// The slots at the corners of a face; what is no face has those of its vertices.
    #[inline]
    fn slots(&self, i: usize, [a, b, c]: [u32; 3]) -> [u32; 3] {
        if !is_face([a, b, c]) {
            return [a, b, c];
        }
        let [of_a, of_b, of_c] = self.of_face[i];
        [self.slot(a, of_a), self.slot(b, of_b), self.slot(c, of_c)]
    }

    /// The wedge that each slot is; `NOBODY` where there is none.
    fn wedges(&self) -> impl Iterator<Item = u32> + '_ {
        let others = self.others.iter().map(|&(_, wedge)| wedge);
        self.first.iter().copied().chain(others)
    }

    /// The wedge that a slot is.
    pub(super) fn wedge(&self, slot: u32) -> u32 {
        let other = || self.others[slot as usize - self.first.len()].1;
        self.first.get(slot as usize).copied().unwrap_or_else(other)
    }

    /// The chart of each slot, as the first slot of its vertex in it; nothing where each is its own.
    fn charts(&self, textures: Option<&[&Layer]>) -> Vec<u32> {
        let Some(textures) = textures.filter(|_| !self.others.is_empty()) else {
            return Vec::new();
        };
        let bits = |layer: &Layer, wedge: u32| -> Vec<u32> {
            layer.of(WedgeId(wedge)).iter().map(|x| x.to_bits()).collect()
        };
        let is_same = |a: u32, b: u32| {
            let [a, b] = [a, b].map(|slot| self.wedge(slot));
            let [own, other] = [a, b].map(|wedge| self.source(wedge));
            self.labels.get(a as usize) == self.labels.get(b as usize)
                && textures.iter().all(|layer| bits(layer, own) == bits(layer, other))
        };
        let vertices = self.first.len() as u32;
        let mut charts: Vec<u32> = (0..vertices + self.others.len() as u32).collect();
        let mut start = vertices;
        for others in self.others.chunk_by(|a, b| a.0 == b.0) {
            let all = start..start + others.len() as u32;
            for slot in all.clone() {
                let before = std::iter::once(others[0].0).chain(start..slot);
                let chart = before.into_iter().find(|&other| is_same(slot, other));
                charts[slot as usize] = chart.unwrap_or(slot);
            }
            start = all.end;
        }
        charts
    }

    /// The wedge of the input that one is, or is split from.
    fn source(&self, wedge: u32) -> u32 {
        match (wedge as usize).checked_sub(self.own) {
            Some(split) if wedge != NOBODY => self.split[split],
            _ => wedge,
        }
    }
}

impl<'m, const K: usize> Painted<'m, K> {
    /// The fields of a mesh whose rings are made; flags the vertices on seams, and puts the squares of
    /// seams in their stars.
    pub(super) fn new(
        mut coat: Coat<'m>,
        corners: Corners<'m>,
        vertices: &mut Vertices,
        faces: impl Iterator<Item = [u32; 3]>,
    ) -> Self {
        let wedges: Vec<u32> = corners.wedges().map(|wedge| corners.source(wedge)).collect();
        coat.fill(&wedges);
        let values = |&wedge: &u32| match wedge {
            NOBODY => Field::EMPTY,
            wedge => Field::of_values(coat.channels_of(wedge)),
        };
        let fields: Vec<Field<K>> = wedges.iter().map(values).collect();
        let mut painted = Self {
            heirs: vec![NOBODY; fields.len()],
            fields,
            seams: Seams::default(),
            charts: corners.charts(coat.textures().as_deref()),
            coat,
            corners,
            scratch: Scratch::new(),
            record: Vec::new(),
            logged: 0,
            none: Field::EMPTY,
        };
        for &(v, _) in &painted.corners.others {
            vertices.get_mut(v).flags.set(Flags::SEAM);
        }
        let mut around = Vec::new();
        for (i, face) in faces.enumerate().filter(|(_, face)| is_face(*face)) {
            let slots = painted.corners.slots(i, face);
            painted.add_face(vertices, face, slots);
            if !painted.corners.others.is_empty() {
                for k in 0..3 {
                    if vertices.get(face[k]).flags.any(Flags::SEAM) {
                        around.push((face[k], face[(k + 1) % 3], slots[k]));
                    }
                }
            }
        }
        painted.sort_sectors(vertices, around);
        painted
    }

    #[inline(always)]
    fn add_face(&mut self, vertices: &Vertices, [a, b, c]: [u32; 3], slots: [u32; 3]) {
        let place = |v: u32| vertices.get(v).place();
        let from = place(a);
        let [own, mut to_b, mut to_c] = slots.map(|slot| self.field(slot).values());
        for (k, own) in own.into_iter().enumerate() {
            to_b[k] -= own;
            to_c[k] -= own;
        }
        let face = Field::face(place(b) - from, place(c) - from, to_b, to_c);
        for slot in slots {
            self.fields[slot as usize].add(&face);
        }
    }

    /// Sectors from the faces around the vertices that have several wedges: vertex, the neighbour where
    /// the face begins, slot.
    fn sort_sectors(&mut self, vertices: &mut Vertices, mut around: Vec<(u32, u32, u32)>) {
        around.sort_unstable();
        for faces in around.chunk_by(|a, b| a.0 == b.0) {
            let v = faces[0].0;
            let begins = |w: u32| {
                let found = faces.binary_search_by_key(&w, |&(_, next, _)| next);
                found.ok().map(|at| faces[at].2)
            };
            let ring = vertices.settled(v);
            let mut slots: Vec<u32> = ring.iter().map(|&w| begins(w).unwrap_or(NOBODY)).collect();
            // The ghost's faces go with those beside them.
            let count = slots.len();
            if let Some(ghost) = ring.iter().position(|&w| w == GHOST) {
                slots[ghost] = slots[(ghost + 1) % count];
                slots[(ghost + count - 1) % count] = slots[(ghost + count - 2) % count];
            }
            if !self.seams.set(v, (ring, &slots), vertices.all.len()) {
                vertices.get_mut(v).flags.clear(Flags::SEAM);
            }
        }
        let mut fences = Vec::new();
        for faces in around.chunk_by(|a, b| a.0 == b.0) {
            let v = faces[0].0;
            for &w in vertices.settled(v).iter().filter(|&&w| w != GHOST) {
                let [own, other] = [(v, w), (w, v)].map(|(v, w)| self.is_cut(v, w));
                if own {
                    fences.push((v, w));
                    if !other {
                        fences.push((w, v));
                    }
                }
            }
        }
        for (v, w) in fences {
            let fence =
                Star::boundary(vertices.get(w).place() - vertices.get(v).place(), SEAM_WEIGHT);
            vertices.get_mut(v).seen.add(&fence);
        }
    }

    /// The attributes of faces, by their numbers and corners in the input; wedges in the input's order.
    pub(super) fn undress(&self, faces: impl Iterator<Item = (u32, [u32; 3])>) -> Attributes {
        let live = self.live();
        let slots = |(i, face): (u32, [u32; 3])| {
            let [a, b, c] = self.corners.slots(i as usize, face);
            [live[a as usize], live[b as usize], live[c as usize]]
        };
        let of_faces: Vec<[u32; 3]> = faces.map(slots).collect();
        let wedges: Vec<u32> = self.corners.wedges().collect();
        let mut used: Vec<u32> = of_faces.as_flattened().to_vec();
        used.sort_unstable_by_key(|&slot| (wedges[slot as usize], slot));
        used.dedup();
        let mut ids = vec![NOBODY; self.fields.len()];
        let mut left: Vec<Left<K>> = Vec::with_capacity(used.len());
        for slot in used {
            let next = self.left(slot, wedges[slot as usize]);
            // Copies of a vertex that have not moved are one again, and so are their wedges.
            let same = |last: &Left<K>| !last.moved && !next.moved && last.own == next.own;
            if !left.last().is_some_and(same) {
                left.push(next);
            }
            ids[slot as usize] = left.len() as u32 - 1;
        }
        let corner = |slot: u32| WedgeId(ids[slot as usize]);
        let corners = of_faces.iter().map(|&[a, b, c]| [corner(a), corner(b), corner(c)]).collect();
        Attributes { corners, wedge_count: left.len(), layers: self.coat.layers(&left) }
    }

    /// The attributes of all faces, wedges as in the input; what is no face has one more.
    pub(super) fn undress_all(&self, faces: impl Iterator<Item = [u32; 3]>) -> Attributes {
        let live = self.live();
        let wedges: Vec<u32> = self.corners.wedges().collect();
        let count = self.corners.own + self.corners.split.len();
        let none = WedgeId::new(count);
        let corner = |slot: u32| WedgeId(wedges[live[slot as usize] as usize]);
        let corners = faces.enumerate().map(|(i, face)| {
            let [a, b, c] = self.corners.slots(i, face);
            if is_face(face) { [corner(a), corner(b), corner(c)] } else { [none; 3] }
        });
        let corners = corners.collect();
        let mut slots = vec![NOBODY; count + 1];
        for (slot, &wedge) in wedges.iter().enumerate().filter(|(_, wedge)| **wedge != NOBODY) {
            slots[wedge as usize] = slot as u32;
        }
        let left = |(wedge, &slot): (usize, &u32)| self.left(slot, wedge as u32);
        let left: Vec<Left<K>> = slots.iter().enumerate().map(left).collect();
        Attributes { corners, wedge_count: left.len(), layers: self.coat.layers(&left) }
    }

    /// What is in a slot, or the input's values of a wedge that no slot has.
    fn left(&self, slot: u32, own: u32) -> Left<K> {
        let is_wedge = (own as usize) < self.corners.own + self.corners.split.len();
        let wedge = if is_wedge { self.corners.source(own) } else { NOBODY };
        if slot == NOBODY {
            return Left { slot: 0, own, wedge, moved: !is_wedge, channels: [0.0; K] };
        }
        // What no face has used has nothing to keep.
        let moved = self.heirs[slot as usize] == slot || !is_wedge;
        Left { slot, own, wedge, moved, channels: self.field(slot).values() }
    }

    /// Takes down what a contraction has made of the wedges of a vertex.
    pub(super) fn take_down(&mut self, vertex: u32) {
        let sectors = self.seams.of(vertex).iter().map(|sector| sector.slot);
        let mut slots: Vec<u32> = sectors.collect();
        if slots.is_empty() {
            slots.push(vertex);
        }
        slots.sort_unstable();
        slots.dedup();
        for slot in slots.into_iter().filter(|&slot| self.heirs[slot as usize] == slot) {
            let own = self.corners.wedge(slot);
            let layers = self.coat.layers(&[self.left(slot, own)]);
            let values = layers.into_iter().flat_map(|layer| layer.values).collect();
            self.record.push(Revalued { number: self.logged, wedge: WedgeId(own), values });
        }
    }

    /// The slot that each is or has become part of.
    fn live(&self) -> Vec<u32> {
        let of = |(slot, &heir): (u32, &u32)| if heir == NOBODY { slot } else { heir };
        let mut live: Vec<u32> = (0..).zip(&self.heirs).map(of).collect();
        for slot in 0..live.len() {
            let mut last = live[slot];
            while live[last as usize] != last {
                last = live[last as usize];
            }
            let mut at = slot;
            while live[at] != last {
                at = std::mem::replace(&mut live[at], last) as usize;
            }
        }
        live
    }
}

fn is_face([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

#[cfg(test)]
pub(super) mod tests;
