//! The slots at the corners of the faces around an edge.

use crate::kernel::attributes::seam_sectors::SeamSectors;
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::collapse::{Ends, WedgePairs};
use crate::kernel::mesh::one_ring::{Vertices, is_seam};

/// Slots of the faces around an edge. For spoke i they are at its apex, at `ids[i]` and at `ids[i +
/// 1]`.
#[derive(Debug, Default)]
pub(crate) struct FaceWedges {
    pub(crate) spokes: Vec<[u32; 3]>,
    /// Slots of the two dying faces, at `v0`, at `v1` and at the wing.
    pub(crate) dying: [[u32; 3]; 2],
    /// Slots of the new vertex in each spoke.
    pub(crate) apexes: Vec<u32>,
}

impl FaceWedges {
    /// Returns the slots of an old face: the spokes first, then the dying faces.
    pub(crate) fn face(&self, i: usize) -> [u32; 3] {
        let len = self.spokes.len();
        if i < len { self.spokes[i] } else { self.dying[i - len] }
    }

    /// Finds all slots around an edge.
    #[inline(always)]
    pub(crate) fn find(
        &mut self,
        seams: &SeamSectors,
        vertices: &Vertices,
        edge_ring: &EdgeRing,
        ends: &Ends,
    ) {
        let Ends { v0, v1, wedge_pairs, .. } = ends;
        let (v0, v1, [at0, at1]) = (*v0, *v1, wedge_pairs.sides);
        let ends_are_seams = [is_seam(vertices, v0), is_seam(vertices, v1)];
        let Self { spokes, dying, .. } = self;
        spokes.clear();
        spokes.resize(edge_ring.len, [0; 3]);
        // Around both ends the ring begins at a wing, after a dying face.
        let mut slot = at0.after;
        for (i, (spoke, &w)) in spokes.iter_mut().zip(edge_ring.ids()).enumerate() {
            let apex = if i < edge_ring.of_v0 { v0 } else { v1 };
            if i == edge_ring.of_v0 {
                slot = at1.after;
            }
            if ends_are_seams[usize::from(i >= edge_ring.of_v0)] {
                slot = seams.next(apex, w, slot);
            }
            spoke[0] = slot;
        }
        let wings = [edge_ring.ids[0], edge_ring.ids[edge_ring.of_v0]];
        *dying = [[at0.after, at1.before, wings[0]], [at0.before, at1.after, wings[1]]];
        for i in 0..edge_ring.len {
            let (w, before) = (edge_ring.ids[i], if i == 0 { edge_ring.len - 1 } else { i - 1 });
            let apexes = [before, i].map(|i| if i < edge_ring.of_v0 { v0 } else { v1 });
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
            } else if i == edge_ring.of_v0 {
                dying[1][2] = sides[1].after;
            }
        }
        self.find_apexes(edge_ring, wedge_pairs);
    }

    fn find_apexes(&mut self, edge_ring: &EdgeRing, wedge_pairs: &WedgePairs) {
        let Self { spokes, apexes, .. } = self;
        apexes.clear();
        apexes.resize(edge_ring.len, 0);
        for (i, apex) in apexes.iter_mut().enumerate() {
            *apex = spokes[i][0];
            if i >= edge_ring.of_v0 {
                let pair = wedge_pairs.pairs().iter().find(|pair| pair[1] == *apex);
                *apex = pair.map_or(*apex, |pair| pair[0]);
            }
        }
        // The ghost's faces take the slots of their neighbours.
        if let Some(ghost) = edge_ring.ghost {
            let at = |i: usize| (ghost + edge_ring.len + i) % edge_ring.len;
            apexes[at(edge_ring.len - 1)] = apexes[at(edge_ring.len - 2)];
            apexes[ghost] = apexes[at(1)];
        }
    }
}
