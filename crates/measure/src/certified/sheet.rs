//! Bounds the distances in a triangle from a surface that lies over it like a sheet.
//!
//! Seen along a direction, faces cover a triangle if none of their free edges crosses it and one
//! point of it is covered: how often a point is covered, counted with signs, changes at free edges
//! only. No point of the triangle is then farther from the surface than the faces over it are, along
//! the direction. Nothing is divided: a plane that two meshes divide in different ways is compared in
//! a time linear in its faces.

mod view;

use std::collections::HashMap;

use glam::DVec3;
use meshlod_mesh::FaceId;

use self::view::{Seen, View};
use crate::prepared::PreparedSurface;
use crate::prepared::mates::Mates;

/// Parts of the bound that may go for shrinking the triangle, so that edges along its own do not
/// cross it: little at first, then as much as coordinates that are rounded may need.
const INSETS: [f64; 2] = [0.02, 0.5];

/// Search for faces that cover a triangle, with its memory.
pub(super) struct Sheet<'s> {
    surface: &'s PreparedSurface<'s>,
    mates: &'s Mates,
    /// Largest rounding error of a position, in model units.
    point: f64,
    /// Faces found, and whether each is turned over against the first.
    found: HashMap<u32, bool>,
    open: Vec<u32>,
}

impl<'s> Sheet<'s> {
    pub(super) fn new(surface: &'s PreparedSurface<'s>, point: f64) -> Self {
        let (mates, found, open) = (surface.mates(), HashMap::new(), Vec::new());
        Self { surface, mates, point, found, open }
    }

    /// Returns a bound on the distances of all points of a triangle from the surface, given a face
    /// that lies over it; `None` if there is none up to `most`.
    pub(super) fn bound(&mut self, triangle: [DVec3; 3], start: FaceId, most: f64) -> Option<f64> {
        let insets = INSETS.into_iter();
        insets.map(|part| part * most).find_map(|inset| self.over(triangle, start, [inset, most]))
    }

    fn over(
        &mut self,
        triangle: [DVec3; 3],
        start: FaceId,
        [inset, most]: [f64; 2],
    ) -> Option<f64> {
        let view = View::of(triangle, self.corners(start), inset)?;
        let first = view.see(self.corners(start));
        let inside = first.over(&view).middle()?;
        self.found.clear();
        self.open.clear();
        self.found.insert(start.0, false);
        self.open.push(start.0);
        let (mut height, mut covered) = (0f64, 0i32);
        while let Some(face) = self.open.pop() {
            let is_turned = self.found[&face];
            let seen = view.see(self.corners(FaceId(face)));
            if seen.height() > height {
                height = height.max(seen.over(&view).height());
            }
            if height + view.spent > most {
                return None;
            }
            let cover = seen.cover(inside, self.point)?;
            covered += if is_turned { -cover } else { cover };
            self.go_on(face, is_turned, &seen, &view)?;
        }
        (covered != 0).then_some(height + view.spent)
    }

    /// Adds the faces across those sides of a face that cross the triangle; `None` if one is a free
    /// edge, or if the faces around have no two sides.
    fn go_on(&mut self, face: u32, is_turned: bool, seen: &Seen, view: &View) -> Option<()> {
        for i in 0..3 {
            let side = seen.side(i);
            if side[0] == side[1] || !view.is_crossed(side, self.point) {
                continue;
            }
            let mate = self.mates.across(self.surface.mesh, 3 * face + i as u32)?;
            let is_mate_turned = is_turned != mate.is_turned;
            match self.found.insert(mate.face.0, is_mate_turned) {
                None => self.open.push(mate.face.0),
                Some(before) if before == is_mate_turned => {}
                Some(_) => return None,
            }
        }
        Some(())
    }

    fn corners(&self, face: FaceId) -> [DVec3; 3] {
        let mesh = self.surface.mesh;
        mesh.faces[face.index()].map(|v| mesh.positions[v.index()].into())
    }
}

#[cfg(test)]
mod tests;
