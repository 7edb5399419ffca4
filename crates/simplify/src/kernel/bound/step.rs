//! A contraction within an error bound.

use glam::Vec3;

use crate::kernel::collapse::edge_ring::EdgeRing;

/// A contraction to be checked against the error bound.
#[derive(Clone, Copy)]
pub(crate) struct BoundedStep<'a> {
    /// Ring of the edge, with the new vertex placed.
    pub(crate) edge_ring: &'a EdgeRing,
    /// Ends of the edge: `v1` is contracted into `v0`.
    pub(crate) ends: [u32; 2],
    /// Old place of `v0`.
    pub(crate) from: Vec3,
    /// New place relative to the old place of `v0`.
    pub(crate) displacement: Vec3,
    /// Squared deviation by this step alone.
    pub(crate) now: f32,
}
