//! What no channel holds of attributes: it moves along, from the closest point of the faces as they were.

use glam::{DVec3, Vec3};
use meshlod_mesh::WedgeId;
use meshlod_spatial::closest_point;

use crate::fast::around::Slots;
use crate::fast::hood::Hood;
use crate::fast::looks::{Ends, Placed};
use crate::fast::painted::Painted;
use crate::fast::vertex::NOBODY;
use crate::interpolate::{Place, shares};

impl<const K: usize> Painted<'_, K> {
    /// Gives the wedges that become one what is closest on the faces that they stand for. Without `slots`
    /// vertices are slots.
    #[inline(always)]
    pub(super) fn move_rest(&mut self, hood: &Hood, placed: &Placed, slots: Option<&Slots>) {
        if self.coat.has_rest() && placed.by != Vec3::ZERO {
            self.move_all_rest(hood, placed, slots);
        }
    }

    fn move_all_rest(&mut self, hood: &Hood, placed: &Placed, slots: Option<&Slots>) {
        let mut values = std::mem::take(&mut self.scratch.rest);
        values.clear();
        let squares = hood.squares_to_old(placed.by);
        let mut taken = [NOBODY; 2];
        for (taken, pair) in taken.iter_mut().zip(placed.ends.met.pairs()) {
            let stands_for = |i: usize| slots.is_none_or(|slots| pair.contains(&slots.face(i)[0]));
            let is_one = |&i: &usize| is_face(hood, i) && stands_for(i);
            let nearest =
                (0..hood.len + 2).filter(is_one).min_by(|&i, &k| squares[i].total_cmp(&squares[k]));
            if let Some(i) = nearest {
                let place = place(hood, placed, i, slots);
                self.coat.rest_at(&place, &mut values);
                *taken = pair[0];
            }
        }
        // Only now: the values before were still wanted.
        let mut left = &values[..];
        for slot in taken.into_iter().filter(|&slot| slot != NOBODY) {
            left = self.coat.set_rest(slot, left);
        }
        self.scratch.rest = values;
    }
}

/// Whether there is this one of the old faces: the spokes, then those that go.
fn is_face(hood: &Hood, i: usize) -> bool {
    match i.checked_sub(hood.len) {
        None => hood.is_face(i),
        Some(dying) => hood.ghost != Some(hood.wing(dying)),
    }
}

/// The new place's closest on one of the old faces.
fn place(hood: &Hood, placed: &Placed, i: usize, slots: Option<&Slots>) -> Place {
    let Ends { v0, v1, .. } = placed.ends;
    let (corners, own) = match i.checked_sub(hood.len) {
        None => {
            let next = (i + 1) % hood.len;
            let (apex, v) = if i < hood.of_v0 { (Vec3::ZERO, v0) } else { (hood.along, v1) };
            ([apex, hood.seen(i), hood.seen(next)], [v, hood.ids[i], hood.ids[next]])
        }
        Some(dying) => {
            let wing = hood.wing(dying);
            ([Vec3::ZERO, hood.along, hood.seen(wing)], [v0, v1, hood.ids[wing]])
        }
    };
    let triangle: [DVec3; 3] = corners.map(|corner| corner.as_dvec3());
    let closest = closest_point(placed.by.as_dvec3(), &triangle);
    let wedges = slots.map_or(own, |slots| slots.face(i)).map(WedgeId);
    Place { wedges, shares: shares(closest, &triangle) }
}
