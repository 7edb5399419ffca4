//! An edge on its way to a contraction: costed, then with its new vertex placed.

use glam::{DVec3, Vec3};

use crate::kernel::bound::BoundedStep;
use crate::kernel::collapse::edge_ring::EdgeRing;
use crate::kernel::collapse::{Collapse, Ends};
use crate::kernel::mesh::one_ring::Vertices;
use crate::kernel::metric::edge_quadric_f64::EdgeQuadricF64;

/// An edge whose cost is within the slack of the front.
pub(super) struct PricedEdge {
    pub(super) ends: Ends,
    /// Quadric of the geometry alone.
    pub(super) quadric: EdgeQuadricF64,
    /// Place of the new vertex relative to the middle of the edge.
    pub(super) from_middle: DVec3,
    /// Bucket of the cost.
    pub(super) bucket: u16,
}

/// A priced edge with its new vertex placed.
pub(crate) struct PlacedEdge {
    pub(super) priced: PricedEdge,
    /// Old place of the vertex that stays, and the new one.
    pub(super) from: Vec3,
    pub(super) place: Vec3,
    /// Square of the distance by which the step would move the surface.
    pub(crate) now: f32,
}

impl PlacedEdge {
    /// Returns the squared distance of all steps together.
    #[inline(always)]
    pub(crate) fn moved(&self, vertices: &Vertices<'_>) -> f32 {
        let Ends { v0, v1, .. } = self.priced.ends;
        self.now + vertices.get(v0).moved.max(vertices.get(v1).moved)
    }

    /// Returns the bucket of the cost.
    pub(crate) fn bucket(&self) -> u16 {
        self.priced.bucket
    }

    #[inline(always)]
    pub(super) fn collapse(&self) -> Collapse {
        let &Self { priced: PricedEdge { ends, ref quadric, .. }, from, place, .. } = self;
        let displacement = place - from;
        let from_middle = displacement.as_dvec3() - quadric.half;
        Collapse { ends, half: quadric.half, from_middle, place, displacement }
    }

    #[inline(always)]
    pub(super) fn step<'a>(&self, edge_ring: &'a EdgeRing) -> BoundedStep<'a> {
        let Ends { v0, v1, .. } = self.priced.ends;
        let &Self { from, place, now, .. } = self;
        BoundedStep { edge_ring, ends: [v0, v1], from, displacement: place - from, now }
    }
}
