//! What quadrics may know of attributes, as the methods see it.

use crate::engine::policy::Memory;
use crate::methods::quadric::Quadric;
use crate::surface::Surface;
use crate::surface::contracted::Contracted;

/// What quadrics know of attributes: `()` for nothing.
pub(crate) trait AttributeMetric: Memory {
    /// The cost of a contraction as a function of the position, seen from the first of the
    /// contracted, where the values may be what fits best.
    fn free(&self, geometry: Quadric, surface: &Surface, of: &Contracted) -> Quadric;

    /// The same where position and values stay those of one of the contracted.
    fn staying(
        &self,
        geometry: Quadric,
        surface: &Surface,
        of: &Contracted,
        kept: usize,
    ) -> Quadric;
}

impl AttributeMetric for () {
    #[inline]
    fn free(&self, geometry: Quadric, _: &Surface, _: &Contracted) -> Quadric {
        geometry
    }

    #[inline]
    fn staying(&self, geometry: Quadric, _: &Surface, _: &Contracted, _: usize) -> Quadric {
        geometry
    }
}
