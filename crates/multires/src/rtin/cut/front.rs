//! The vertices inserted so far, and the triangles between them.
//!
//! A triangle is known by the vertex at its right angle, which created it, and the side of that
//! vertex on which its hypotenuse lies: a vertex creates up to four.

use super::slots::TriangleSlots;
use crate::forest::NONE;
use crate::rtin::Rtin;
use crate::rtin::grid::{Diamond, Extent, GridPoint, RightTriangle, middle};

/// Slots of the triangles that a vertex created, by the side of their hypotenuse; `NONE` where the
/// triangle has been bisected or lies outside the field.
type SlotsAround = [u32; 4];

/// The vertices of a cut and its triangles.
#[derive(Clone, Debug)]
pub(super) struct FieldFront<'m> {
    pub(super) model: &'m Rtin,
    /// Index in `around` of each vertex of the cut; `NONE` for the others.
    entries: Vec<u32>,
    around: Vec<SlotsAround>,
    /// Entries of `around` that no vertex uses.
    unused: Vec<u32>,
    /// The vertices in every level and the one in the middle of the square: all others depend on
    /// one of these, or on one that does.
    pub(super) first: Vec<u32>,
    pub(super) triangles: TriangleSlots,
}

impl<'m> FieldFront<'m> {
    /// Starts at the coarsest level.
    ///
    /// Cost: O(n), n = vertices of the field.
    pub(super) fn new(model: &'m Rtin) -> Self {
        let mut this = Self {
            model,
            entries: vec![NONE; model.vertices.len()],
            around: Vec::new(),
            unused: Vec::new(),
            first: Vec::new(),
            triangles: TriangleSlots::default(),
        };
        let forced = (0..).zip(&model.vertices).filter(|(_, vertex)| vertex.is_forced());
        this.first = forced.map(|(index, _)| index).collect();
        (0..this.first.len()).for_each(|i| this.enter(this.first[i]));
        let center = middle(model.grid.roots()[0].ends);
        if model.grid.depth() > 0 && model.grid.holds(center) {
            this.first.push(model.grid.index(center) as u32);
        }
        model.grid.roots().into_iter().for_each(|root| this.start(root));
        this
    }

    /// Adds the triangles of the coarsest level within a triangle.
    fn start(&mut self, triangle: RightTriangle) {
        let grid = &self.model.grid;
        let extent = grid.extent(&triangle);
        let at = middle(triangle.ends);
        match extent {
            Extent::Outside => {}
            // Every triangle across the border is bisected.
            Extent::Inside if triangle.is_finest() || !self.has(grid.index(at)) => {
                self.add(&triangle);
            }
            _ => triangle.halves().into_iter().for_each(|half| self.start(half)),
        }
    }

    /// Returns the number of vertices.
    pub(super) fn vertex_count(&self) -> usize {
        self.around.len() - self.unused.len()
    }

    /// Returns true if the cut has a vertex.
    #[inline]
    pub(super) fn has(&self, index: usize) -> bool {
        self.entries[index] != NONE
    }

    /// Returns the slot of a triangle; `None` if the cut does not have it.
    pub(super) fn slot(&self, triangle: &RightTriangle) -> Option<u32> {
        let grid = &self.model.grid;
        let apex = grid.holds(triangle.apex).then(|| grid.index(triangle.apex))?;
        let entry = *self.around.get(self.entries[apex] as usize)?;
        Some(entry[triangle.side()]).filter(|&slot| slot != NONE)
    }

    /// Inserts a vertex that the coarsest level lacks; the cut must have all that it depends on.
    pub(super) fn insert(&mut self, place: GridPoint) {
        self.enter(self.model.grid.index(place) as u32);
        for coarse in self.coarse(place) {
            let Some(slot) = self.slot(&coarse) else { continue };
            *self.slot_mut(&coarse) = NONE;
            let [first, second] = coarse.halves();
            self.triangles.replace(slot, self.nodes(&first));
            *self.slot_mut(&first) = slot;
            self.add(&second);
        }
    }

    /// Removes a vertex that the coarsest level lacks and no vertex of the cut depends on.
    pub(super) fn remove(&mut self, place: GridPoint) {
        for coarse in self.coarse(place) {
            let [first, second] = coarse.halves().map(|half| self.slot(&half));
            let (Some(first), Some(second)) = (first, second) else { continue };
            self.triangles.replace(first, self.nodes(&coarse));
            *self.slot_mut(&coarse) = first;
            self.triangles.remove(second);
        }
        let index = self.model.grid.index(place);
        self.unused.push(std::mem::replace(&mut self.entries[index], NONE));
    }

    /// Returns the triangles that the insertion of a vertex removes, without those outside the
    /// field.
    fn coarse(&self, place: GridPoint) -> impl Iterator<Item = RightTriangle> + use<> {
        // A triangle inside has its right angle in the field, one outside has not: the coarsest
        // level has every vertex of a triangle across the border.
        let grid = self.model.grid;
        let all = grid.diamond(place).into_iter().flat_map(|diamond: Diamond| diamond.coarse());
        all.filter(move |triangle| grid.holds(triangle.apex))
    }

    fn enter(&mut self, index: u32) {
        let entry = self.unused.pop().unwrap_or(self.around.len() as u32);
        match self.around.get_mut(entry as usize) {
            Some(around) => *around = [NONE; 4],
            None => self.around.push([NONE; 4]),
        }
        self.entries[index as usize] = entry;
    }

    fn add(&mut self, triangle: &RightTriangle) {
        let slot = self.triangles.add(self.nodes(triangle));
        *self.slot_mut(triangle) = slot;
    }

    fn slot_mut(&mut self, triangle: &RightTriangle) -> &mut u32 {
        let entry = self.entries[self.model.grid.index(triangle.apex)];
        &mut self.around[entry as usize][triangle.side()]
    }

    /// Returns the nodes at the corners of a triangle, counter-clockwise seen from outside.
    fn nodes(&self, triangle: &RightTriangle) -> [u32; 3] {
        let corners = triangle.corners().map(|corner| self.model.grid.index(corner) as u32);
        self.model.turned(corners)
    }
}
