//! Conversion of the corners of faces to wedges with quadrics, and back.

use meshlod_mesh::{Attributes, WedgeId};

use crate::kernel::attributes::RecordedValues;
use crate::kernel::attributes::attribute_quadric::AttributeQuadric;
use crate::kernel::attributes::corners::Corners;
use crate::kernel::attributes::layers::{AttributeLayers, SurvivingWedge};
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::attributes::wedge_store::WedgeStore;
use crate::kernel::mesh::one_ring::{GHOST, Vertices};
use crate::kernel::mesh::vertex::{NO_VERTEX, VertexFlags};
use crate::kernel::metric::Metric;
use crate::kernel::setup::vertex_order::is_face;

impl<'m, M: Metric, const K: usize> WedgeStore<'m, M, K> {
    /// Builds the quadrics of a mesh whose rings are made. Flags the vertices on seams, and adds
    /// the seam quadrics to them.
    pub(crate) fn new(
        layers: AttributeLayers<'m>,
        corners: Corners<'m>,
        vertices: &mut Vertices,
        faces: impl Iterator<Item = [u32; 3]>,
    ) -> Self {
        let mut store = Self::without_faces(layers, corners);
        for &(v, _) in &store.corners.others {
            vertices.get_mut(v).flags.set(VertexFlags::SEAM);
        }
        let mut around = Vec::new();
        let mut whole = store.whole();
        for (i, face) in faces.enumerate().filter(|(_, face)| is_face(*face)) {
            let slots = whole.corners.slots(i, face);
            whole.add_face(vertices, face, slots);
            if !whole.corners.others.is_empty() {
                for k in 0..3 {
                    if vertices.get(face[k]).flags.any(VertexFlags::SEAM) {
                        around.push((face[k], face[(k + 1) % 3], slots[k]));
                    }
                }
            }
        }
        whole.sort_sectors(vertices, around);
        store
    }

    /// Returns the attributes of faces, given by their indices and corners in the kernel's
    /// vertices. The wedges are in the input's order.
    pub(crate) fn to_attributes(&self, faces: impl Iterator<Item = (u32, [u32; 3])>) -> Attributes {
        let live = self.live_slots();
        let slots = |(i, face): (u32, [u32; 3])| {
            let [a, b, c] = self.corners.slots(i as usize, face);
            [live[a as usize], live[b as usize], live[c as usize]]
        };
        let of_faces: Vec<[u32; 3]> = faces.map(slots).collect();
        let wedges: Vec<u32> = self.corners.wedges().collect();
        let mut used: Vec<u32> = of_faces.as_flattened().to_vec();
        used.sort_unstable_by_key(|&slot| (wedges[slot as usize], slot));
        used.dedup();
        let mut ids = vec![NO_VERTEX; self.quadrics.len()];
        let mut left: Vec<SurvivingWedge<K>> = Vec::with_capacity(used.len());
        for slot in used {
            let next = self.left(slot, wedges[slot as usize]);
            // Copies of a vertex that have not moved are one again, and so are their wedges.
            let same =
                |last: &SurvivingWedge<K>| !last.moved && !next.moved && last.own == next.own;
            if !left.last().is_some_and(same) {
                left.push(next);
            }
            ids[slot as usize] = left.len() as u32 - 1;
        }
        let corner = |slot: u32| WedgeId(ids[slot as usize]);
        let corners = of_faces.iter().map(|&[a, b, c]| [corner(a), corner(b), corner(c)]).collect();
        Attributes {
            corners,
            wedge_count: left.len(),
            layers: self.layers.layers(&left, |number, slot| self.uncosted(number, slot)),
        }
    }

    /// Returns the attributes of all faces, with the input's wedge indices. Degenerate faces have
    /// one extra wedge, and so has each vertex of a cut.
    pub(crate) fn to_all_attributes(&self, faces: impl Iterator<Item = [u32; 3]>) -> Attributes {
        let live = self.live_slots();
        let mut wedges: Vec<u32> = self.corners.wedges().collect();
        let mut count = self.corners.own + self.corners.split.len();
        let none = WedgeId::new(count);
        for (slot, wedge) in (0..).zip(&mut wedges).filter(|(_, wedge)| **wedge == NO_VERTEX) {
            if self.merged_into[slot as usize] == slot {
                *wedge = self.corners.wedge_of(slot);
                count = count.max(*wedge as usize);
            }
        }
        let corner = |slot: u32| WedgeId(wedges[live[slot as usize] as usize]);
        let corners = faces.enumerate().map(|(i, face)| {
            let [a, b, c] = self.corners.slots(i, face);
            if is_face(face) { [corner(a), corner(b), corner(c)] } else { [none; 3] }
        });
        let corners = corners.collect();
        let mut slots = vec![NO_VERTEX; count + 1];
        for (slot, &wedge) in wedges.iter().enumerate().filter(|(_, wedge)| **wedge != NO_VERTEX) {
            slots[wedge as usize] = slot as u32;
        }
        let left = |(wedge, &slot): (usize, &u32)| self.left(slot, wedge as u32);
        let left: Vec<SurvivingWedge<K>> = slots.iter().enumerate().map(left).collect();
        Attributes {
            corners,
            wedge_count: left.len(),
            layers: self.layers.layers(&left, |number, slot| self.uncosted(number, slot)),
        }
    }

    /// Returns the values in a slot, or the input's values of a wedge without a slot.
    fn left(&self, slot: u32, own: u32) -> SurvivingWedge<K> {
        let is_wedge = self.corners.is_of_input(own);
        let wedge = self.corners.source(own);
        if slot == NO_VERTEX {
            return SurvivingWedge { slot: 0, own, wedge, moved: !is_wedge, channels: [0.0; K] };
        }
        // A slot that no face uses has nothing to keep.
        let moved = self.merged_into[slot as usize] == slot || !is_wedge;
        SurvivingWedge { slot, own, wedge, moved, channels: self.quadrics[slot as usize].values() }
    }

    /// Returns for each slot the live slot that it is or has been merged into.
    fn live_slots(&self) -> Vec<u32> {
        let of = |(slot, &target): (u32, &u32)| if target == NO_VERTEX { slot } else { target };
        let mut live: Vec<u32> = (0..).zip(&self.merged_into).map(of).collect();
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

impl<M: Metric, const K: usize> WedgeQuadrics<'_, M, K> {
    #[inline(always)]
    fn add_face(&mut self, vertices: &Vertices, [a, b, c]: [u32; 3], slots: [u32; 3]) {
        let place = |v: u32| vertices.get(v).place();
        let from = place(a);
        let [own, mut to_b, mut to_c] = slots.map(|slot| self.quadric(slot).values());
        for (k, own) in own.into_iter().enumerate() {
            to_b[k] -= own;
            to_c[k] -= own;
        }
        let face = AttributeQuadric::face::<M>(place(b) - from, place(c) - from, to_b, to_c);
        for slot in slots {
            self.quadrics.get_mut(slot).add(&face);
        }
    }

    /// Builds the sectors of the vertices with several wedges from the faces around: the vertex,
    /// the neighbour where the face begins, and the slot.
    fn sort_sectors(&mut self, vertices: &mut Vertices, mut around: Vec<(u32, u32, u32)>) {
        around.sort_unstable();
        for faces in around.chunk_by(|a, b| a.0 == b.0) {
            let v = faces[0].0;
            let begins = |w: u32| {
                let found = faces.binary_search_by_key(&w, |&(_, next, _)| next);
                found.ok().map(|at| faces[at].2)
            };
            let ring = vertices.neighbours(v);
            let mut slots: Vec<u32> =
                ring.iter().map(|&w| begins(w).unwrap_or(NO_VERTEX)).collect();
            // The ghost's faces take the slots of their neighbours.
            let count = slots.len();
            if let Some(ghost) = ring.iter().position(|&w| w == GHOST) {
                slots[ghost] = slots[(ghost + 1) % count];
                slots[(ghost + count - 1) % count] = slots[(ghost + count - 2) % count];
            }
            if !self.seams.set(v, (ring, &slots)) {
                vertices.get_mut(v).flags.clear(VertexFlags::SEAM);
            }
        }
        let mut constraints = Vec::new();
        for faces in around.chunk_by(|a, b| a.0 == b.0) {
            let v = faces[0].0;
            for &w in vertices.neighbours(v).iter().filter(|&&w| w != GHOST) {
                let [own, other] = [(v, w), (w, v)].map(|(v, w)| self.is_cut(v, w));
                if own {
                    constraints.push((v, w));
                    if !other {
                        constraints.push((w, v));
                    }
                }
            }
        }
        for (v, w) in constraints {
            let constraint = M::seam(vertices.get(w).place() - vertices.get(v).place());
            vertices.get_mut(v).quadric.add(&constraint);
        }
    }

    /// Records the values that a contraction has given to the wedges of a vertex.
    pub(crate) fn record_values(&mut self, vertex: u32) {
        let sectors = self.seams.of(vertex).iter().map(|sector| sector.slot);
        let mut slots: Vec<u32> = sectors.collect();
        if slots.is_empty() {
            slots.push(vertex);
        }
        slots.sort_unstable();
        slots.dedup();
        for slot in slots.into_iter().filter(|&slot| self.merged_into.at(slot) == slot) {
            let own = self.corners.wedge_of(slot);
            let wedge = self.corners.source(own);
            let channels = self.quadric(slot).values();
            let left = [SurvivingWedge { slot, own, wedge, moved: true, channels }];
            let layers = self.layers.layers(&left, |number, slot| self.carried.of(number, slot));
            let values = layers.into_iter().flat_map(|layer| layer.values).collect();
            let number = self.record.steps;
            self.record.values.push(RecordedValues { number, wedge: WedgeId(own), values });
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
