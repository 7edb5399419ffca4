//! Bounds the distances in a triangle from a surface that lies over it like a sheet.
//!
//! Seen along a direction, faces cover a triangle if none of their free edges crosses it and one
//! point of it is covered: how often a point is covered, counted with signs, changes at free edges
//! only. No point of the triangle is then farther from the surface than the faces over it are, along
//! the direction. Nothing is divided: a plane that two meshes divide in different ways is compared in
//! a time linear in its faces.

#[cfg(test)]
mod tests;
mod view;

use std::cmp::Ordering;

use glam::DVec3;
use meshlod_mesh::FaceId;

use self::view::{ROUNDING, View, normal};
use crate::mates::Mates;
use crate::{Bvh, Triangle};

/// Fractions of the bound that may be spent on shrinking the triangle, so that edges running along
/// its own sides do not cross it: little at first, then most of what the height of a face leaves.
const LITTLE: f64 = 0.02;
const MUCH: f64 = 0.9;

/// Most faces that are crossed on the way from the first one to one over the middle.
const MOST_STEPS: usize = 64;

/// Search for faces of a surface that cover a triangle, with its memory.
///
/// Size: 4 bytes for each face of the surface.
#[derive(Clone, Debug)]
pub struct Sheet<'s> {
    surface: &'s Bvh,
    mates: &'s Mates,
    /// Twice the number of the search that found each slot last, plus one if it was turned over.
    stamps: Vec<u32>,
    search: u32,
    /// Slots of faces whose sides have not been looked at, and whether each is turned over.
    open: Vec<(u32, bool)>,
}

/// Distance of a triangle from a surface, as a [`Sheet`] found it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cover {
    /// No point is farther from the surface than this.
    Within(f64),
    /// Over this point, a face is farther away than is allowed. Another may be near.
    High([f64; 3]),
    /// No faces were found that cover it.
    Open,
}

impl<'s> Sheet<'s> {
    /// Creates a search over a surface with its mates.
    pub fn new(surface: &'s Bvh, mates: &'s Mates) -> Self {
        Self { surface, mates, stamps: Vec::new(), search: 0, open: Vec::new() }
    }

    /// Looks for faces that cover a triangle and are nowhere farther from it than `most`, beginning
    /// at that of some faces near it which is most nearly parallel. Up to `enough`, a face may count
    /// as far as its farthest corner, even one that is not over the triangle. Lengths and positions
    /// are in model units.
    ///
    /// Cost: linear in the number of faces that lie over it.
    pub fn cover(
        &mut self,
        triangle: [[f64; 3]; 3],
        near: &[FaceId],
        [enough, most]: [f64; 2],
    ) -> Cover {
        let frame = &self.surface.frame;
        let (local, scale) = (triangle.map(|at| frame.local(at)), frame.scale());
        let [enough, most] = [enough, most].map(|limit| limit * scale - ROUNDING);
        if most.is_nan() || most <= 0.0 {
            return Cover::Open;
        }
        // Along its normal, or that of the face: a thin triangle may have any.
        let own = normal(&local);
        let near = near.iter().map(|face| self.surface.slots[face.index()]);
        let near = near.map(|slot| (slot, normal(self.corners(slot))));
        let slope = |other: Option<DVec3>| Some(own?.dot(other?).abs());
        let parallel =
            near.max_by(|a, b| slope(a.1).partial_cmp(&slope(b.1)).unwrap_or(Ordering::Equal));
        let Some((start, other)) = parallel else { return Cover::Open };
        let from = self.corners(start)[0];
        let height = |direction: DVec3| local.map(|at| direction.dot(at - from).abs());
        let height = other.map(height).map_or(0.0, |[a, b, c]| a.max(b).max(c));
        let (little, much) = (LITTLE * most, MUCH * (most - height).max(0.0));
        let mut high = None;
        for (direction, inset) in [(own, little), (own, much), (other, much)] {
            let Some(direction) = direction else { continue };
            match self.over(&View::along(direction, &local, inset), start, [enough, most]) {
                Ok(height) => return Cover::Within((height + ROUNDING) / scale),
                // Along another direction than its own, a point is not one of the triangle.
                Err(at) => high = high.or(at.filter(|_| Some(direction) == own)),
            }
        }
        high.map_or(Cover::Open, |at| Cover::High(frame.model(at)))
    }

    /// Returns the bound in the hierarchy's frame, or a point over which a face is too far away.
    fn over(
        &mut self,
        view: &View,
        start: u32,
        [enough, most]: [f64; 2],
    ) -> Result<f64, Option<DVec3>> {
        if view.spent >= most {
            return Err(None);
        }
        let start = self.walk_to_middle(start, view);
        self.begin();
        self.find(start, false);
        self.open.push((start, false));
        let [enough, most] = [enough, most].map(|limit| limit - view.spent);
        let (mut height, mut covered) = (0f64, 0i32);
        while let Some((slot, is_turned)) = self.open.pop() {
            let seen = view.see(self.corners(slot));
            let overlap = view.compare(&seen);
            let by_corners = seen.height();
            if by_corners <= enough {
                height = height.max(by_corners);
            } else if by_corners > height {
                let highest = overlap.highest();
                height = height.max(highest.z.abs());
                if height > most {
                    return Err(Some(view.at(highest)));
                }
            }
            let cover = overlap.cover().ok_or(None)?;
            covered += if is_turned { -cover } else { cover };
            self.go_on((slot, is_turned), overlap.crossed_sides()).ok_or(None)?;
        }
        if covered == 0 { Err(None) } else { Ok(height + view.spent) }
    }

    /// Goes from face to face towards the one over the middle of the triangle, as far as it gets.
    fn walk_to_middle(&self, mut slot: u32, view: &View) -> u32 {
        for _ in 0..MOST_STEPS {
            let Some(side) = view.see(self.corners(slot)).side_towards_middle() else { break };
            let Some(mate) = self.mates.across(slot, side) else { break };
            slot = mate.slot;
        }
        slot
    }

    /// Adds the faces across those sides of a face that cross the triangle; `None` if one is a free
    /// edge, or if the faces are not orientable.
    fn go_on(&mut self, (slot, is_turned): (u32, bool), is_crossed: [bool; 3]) -> Option<()> {
        for side in (0..3).filter(|&side| is_crossed[side]) {
            let mate = self.mates.across(slot, side)?;
            let is_mate_turned = is_turned != mate.is_turned;
            match self.find(mate.slot, is_mate_turned) {
                None => self.open.push((mate.slot, is_mate_turned)),
                Some(before) if before == is_mate_turned => {}
                Some(_) => return None,
            }
        }
        Some(())
    }

    /// Begins a search that has found nothing yet.
    fn begin(&mut self) {
        const LAST: u32 = u32::MAX / 2;
        if self.stamps.is_empty() || self.search == LAST {
            self.stamps = vec![0; self.surface.slots.len()];
            self.search = 0;
        }
        self.search += 1;
        self.open.clear();
    }

    /// Notes that a face is found; returns whether it was turned over if it was found before.
    fn find(&mut self, slot: u32, is_turned: bool) -> Option<bool> {
        let stamp = &mut self.stamps[slot as usize];
        if *stamp / 2 == self.search {
            return Some(*stamp % 2 == 1);
        }
        *stamp = 2 * self.search + u32::from(is_turned);
        None
    }

    fn corners(&self, slot: u32) -> &'s Triangle {
        &self.surface.triangles[slot as usize]
    }
}
