//! Decoded positions of a block, from which attributes are predicted.

use glam::{DVec2, DVec3};

use super::adjacency::{BlockFaces, next, previous};

/// Faces of a block with the positions of its vertices, in cells.
#[derive(Clone, Debug)]
pub(in super::super) struct BlockGeometry<'a> {
    pub(super) faces: BlockFaces<'a>,
    points: Vec<DVec3>,
}

impl<'a> BlockGeometry<'a> {
    pub(in super::super) fn new(faces: &'a [[u16; 3]], points: Vec<DVec3>) -> Self {
        Self { faces: BlockFaces::new(faces), points }
    }

    #[inline]
    pub(super) fn point(&self, corner: usize) -> DVec3 {
        self.points[usize::from(self.faces.faces.as_flattened()[corner])]
    }

    /// Returns a corner's place relative to an edge: along the edge, and how far beside it, both in
    /// lengths of the edge. `None` if the edge has no length.
    pub(super) fn frame(&self, a: usize, b: usize, corner: usize) -> Option<DVec2> {
        let (a, b, c) = (self.point(a), self.point(b), self.point(corner));
        let (edge, way) = (b - a, c - a);
        let squared = edge.length_squared();
        let place = DVec2::new(way.dot(edge), edge.cross(way).length()) / squared;
        (squared > 0.0 && place.y > 0.0).then_some(place)
    }

    /// Returns the edges from a corner to the next one and to the previous one.
    #[inline]
    pub(super) fn edges(&self, corner: usize) -> [DVec3; 2] {
        let at = self.point(corner);
        [self.point(next(corner)) - at, self.point(previous(corner)) - at]
    }
}
