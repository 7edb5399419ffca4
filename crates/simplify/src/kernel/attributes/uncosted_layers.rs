//! Attributes outside the metric: interpolated at the closest point of the old faces.

use glam::{DVec3, Vec3};
use meshlod_mesh::WedgeId;
use meshlod_spatial::closest_point;

use crate::kernel::attributes::face_wedges::FaceWedges;
use crate::kernel::attributes::wedge_quadrics::WedgeQuadrics;
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::collapse::{Collapse, Ends};
use crate::kernel::metric::Metric;
use crate::surface::interpolate::{Place, shares};

impl<M: Metric, const K: usize> WedgeQuadrics<'_, M, K> {
    /// Gives merged wedges the values at the closest point of the old faces that they belong to.
    /// Without `slots`, the slots are the vertices.
    #[inline(always)]
    pub(crate) fn move_uncosted(
        &mut self,
        edge_ring: &EdgeRing,
        collapse: &Collapse,
        slots: Option<&FaceWedges>,
    ) {
        let moves = !collapse.keeps_values() || collapse.ends.cuts_seam;
        if !self.carried.is_empty() && moves {
            self.move_all_uncosted(edge_ring, collapse, slots);
        }
    }

    fn move_all_uncosted(
        &mut self,
        edge_ring: &EdgeRing,
        collapse: &Collapse,
        slots: Option<&FaceWedges>,
    ) {
        let mut values = std::mem::take(&mut self.scratch.uncosted);
        values.clear();
        let squares = edge_ring.squared_distances_to_old(collapse.displacement);
        let mut taken = std::mem::take(&mut self.scratch.taken);
        taken.clear();
        self.collect_merged(collapse, &mut taken);
        taken.retain(|pair| {
            let stands_for = |i: usize| slots.is_none_or(|slots| pair.contains(&slots.face(i)[0]));
            let is_one = |&i: &usize| is_face(edge_ring, i) && stands_for(i);
            let nearest = (0..edge_ring.len + 2)
                .filter(is_one)
                .min_by(|&i, &k| squares[i].total_cmp(&squares[k]));
            if let Some(i) = nearest {
                let place = place(edge_ring, collapse, i, slots);
                self.carried.at(&place, &mut values);
            }
            nearest.is_some()
        });
        // Only now: until here the old values were needed.
        let mut left = &values[..];
        for &[slot, _] in &taken {
            left = self.carried.set(slot, left);
        }
        let [first, _] = collapse.ends.wedge_pairs.pairs()[0];
        for &[slot, _] in taken.iter().filter(|[slot, merged]| slot == merged) {
            self.carried.copy_skin(slot, first);
        }
        (self.scratch.uncosted, self.scratch.taken) = (values, taken);
    }

    /// Collects the pairs of slots that become one; slots whose chart does not go on along the edge
    /// are paired with themselves.
    fn collect_merged(&self, collapse: &Collapse, merged: &mut Vec<[u32; 2]>) {
        let ends = &collapse.ends;
        let stays = collapse.keeps_values();
        if !stays {
            merged.extend(ends.wedge_pairs.pairs());
        }
        for end in (0..2).filter(|&end| ends.cuts_seam && (end == 1 || !stays)) {
            let joins = |slot: u32| {
                ends.wedge_pairs
                    .pairs()
                    .iter()
                    .any(|pair| self.chart(pair[end]) == self.chart(slot))
            };
            merged.extend(
                self.unpaired(ends, end).filter(|&slot| !joins(slot)).map(|slot| [slot; 2]),
            );
        }
    }
}

/// Returns true if an old face exists: the spokes first, then the dying faces.
fn is_face(edge_ring: &EdgeRing, i: usize) -> bool {
    match i.checked_sub(edge_ring.len) {
        None => edge_ring.is_face(i),
        Some(dying) => edge_ring.ghost != Some(edge_ring.wing(dying)),
    }
}

/// Returns the point of an old face closest to the new place.
fn place(edge_ring: &EdgeRing, collapse: &Collapse, i: usize, slots: Option<&FaceWedges>) -> Place {
    let Ends { v0, v1, .. } = collapse.ends;
    let (corners, own) = match i.checked_sub(edge_ring.len) {
        None => {
            let next = (i + 1) % edge_ring.len;
            let (apex, v) =
                if i < edge_ring.of_v0 { (Vec3::ZERO, v0) } else { (edge_ring.along, v1) };
            (
                [apex, edge_ring.relative(i), edge_ring.relative(next)],
                [v, edge_ring.ids[i], edge_ring.ids[next]],
            )
        }
        Some(dying) => {
            let wing = edge_ring.wing(dying);
            ([Vec3::ZERO, edge_ring.along, edge_ring.relative(wing)], [v0, v1, edge_ring.ids[wing]])
        }
    };
    let triangle: [DVec3; 3] = corners.map(|corner| corner.as_dvec3());
    let closest = closest_point(collapse.displacement.as_dvec3(), &triangle);
    let wedges = slots.map_or(own, |slots| slots.face(i)).map(WedgeId);
    Place { wedges, shares: shares(closest, &triangle) }
}
