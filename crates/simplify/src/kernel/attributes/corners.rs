//! The wedges at the corners of the input's faces.

use std::borrow::Cow;
use std::ops::Range;

use meshlod_mesh::{Layer, Mesh, WedgeId};
use rustc_hash::FxHashMap;

use crate::kernel::attributes::slots::SlotRanges;
use crate::kernel::mesh::vertex::NO_VERTEX;
use crate::kernel::setup::vertex_order::is_face;
use crate::surface::wedges::labels;

/// Wedges at the corners of a mesh, split where the material or the object changes.
pub(crate) struct Corners<'m> {
    of_face: Cow<'m, [[WedgeId; 3]]>,
    /// Input wedges that the wedges after the first `own` are split from.
    pub(crate) split: Vec<u32>,
    pub(crate) own: usize,
    /// Material and object label of each wedge, if there are several.
    labels: Vec<u32>,
    /// First wedge of each vertex.
    first: Vec<u32>,
    /// True if the mesh has attributes, false if there are wedges for its labels alone.
    pub(crate) are_given: bool,
    /// Further wedges of vertices, sorted. Their slots follow those of the vertices.
    pub(crate) others: Vec<(u32, u32)>,
}

impl<'m> Corners<'m> {
    /// Finds the wedges of a mesh; `None` if no vertex can have several. `faces` are those of the
    /// mesh with copies of vertices, `vertices` is the number of vertices with copies.
    pub(crate) fn new(
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
            first: vec![NO_VERTEX; vertices],
            others: Vec::new(),
        };
        if let Some(labels) = labels {
            corners.split_by(&labels);
        }
        corners.find(faces);
        Some(corners)
    }

    /// Gives each label wedges of its own. The first label to use a wedge keeps it.
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
                if *first == NO_VERTEX {
                    *first = wedge.0;
                } else if *first != wedge.0 {
                    self.others.push((v, wedge.0));
                }
            }
        }
        self.others.sort_unstable();
        self.others.dedup();
    }

    /// Returns the slot of a wedge at a vertex. A vertex of a cut has one slot alone.
    #[inline]
    fn slot(&self, v: u32, wedge: WedgeId) -> u32 {
        let first = self.first[v as usize];
        if first == wedge.0 || first == NO_VERTEX {
            return v;
        }
        let found = self.others.binary_search(&(v, wedge.0)).unwrap_or_default();
        (self.first.len() + found) as u32
    }

    /// Returns the slots at the corners of a face; the vertices themselves for a degenerate face.
    #[inline]
    pub(crate) fn slots(&self, i: usize, [a, b, c]: [u32; 3]) -> [u32; 3] {
        if !is_face([a, b, c]) {
            return [a, b, c];
        }
        let [of_a, of_b, of_c] = self.of_face[i];
        [self.slot(a, of_a), self.slot(b, of_b), self.slot(c, of_c)]
    }

    /// Returns the wedge of each slot, or `NO_VERTEX`.
    pub(crate) fn wedges(&self) -> impl Iterator<Item = u32> + '_ {
        let others = self.others.iter().map(|&(_, wedge)| wedge);
        self.first.iter().copied().chain(others)
    }

    /// Returns the wedge of a slot.
    pub(crate) fn wedge(&self, slot: u32) -> u32 {
        let other = || self.others[slot as usize - self.first.len()].1;
        self.first.get(slot as usize).copied().unwrap_or_else(other)
    }

    /// Returns the wedge of a slot; that of a vertex of a cut comes after those of the input.
    pub(crate) fn wedge_of(&self, slot: u32) -> u32 {
        match self.wedge(slot) {
            NO_VERTEX => (self.own + self.split.len()) as u32 + 1 + slot,
            wedge => wedge,
        }
    }

    /// Returns true if a wedge is one of the input, or was split from one.
    pub(crate) fn is_of_input(&self, wedge: u32) -> bool {
        (wedge as usize) < self.own + self.split.len()
    }

    /// Returns the ranges of the slots of the vertices in a range.
    pub(crate) fn slots_of(&self, vertices: Range<usize>) -> SlotRanges {
        let at = |v: usize| self.others.partition_point(|&(of, _)| (of as usize) < v);
        SlotRanges { others: at(vertices.start)..at(vertices.end), vertices }
    }

    /// Returns the number of vertices, which have the first slots.
    pub(crate) fn vertices(&self) -> usize {
        self.first.len()
    }

    /// Returns the chart of each slot, which is the first slot of its vertex in the chart. Empty if
    /// each slot is its own chart.
    pub(crate) fn charts(&self, textures: Option<&[&Layer]>) -> Vec<u32> {
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

    /// Returns the input wedge from which a wedge was split, or the wedge itself; [`NO_VERTEX`] for those
    /// of cuts.
    pub(crate) fn source(&self, wedge: u32) -> u32 {
        match (wedge as usize).checked_sub(self.own) {
            Some(split) => self.split.get(split).copied().unwrap_or(NO_VERTEX),
            None => wedge,
        }
    }
}
