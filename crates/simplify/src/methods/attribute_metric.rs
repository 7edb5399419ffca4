//! Attribute term of the quadric methods.

use crate::engine::policy::Memory;
use crate::methods::quadric::Quadric;
use crate::surface::Surface;
use crate::surface::contracted::Contracted;

/// Attribute term added to geometric quadrics; `()` for none.
pub(crate) trait AttributeMetric: Memory {
    /// Returns the cost of a contraction as a function of the position, relative to the first
    /// contracted vertex, with the attribute values that fit best.
    fn free(&self, geometry: Quadric, surface: &Surface, of: &Contracted) -> Quadric;

    /// Returns the cost of a contraction when position and values stay those of one contracted
    /// vertex.
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
