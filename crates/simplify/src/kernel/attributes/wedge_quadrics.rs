//! Attributes in the fast engine: a field at each wedge, beside the vertices.
//!
//! A wedge is known by its slot: a vertex's first has the vertex's own number, the others follow after
//! all of these. So a mesh without seams asks nobody which wedge it is.
//!
//! SeamSectors are contracted along themselves, both sides at once; a vertex that has no seam goes into one
//! that has, which stays where it is. So do the ends of seams, and where several meet.

use std::marker::PhantomData;

use crate::kernel::attributes::RecordedValues;
use crate::kernel::attributes::attribute_quadric::AttributeQuadric;
use crate::kernel::attributes::corners::Corners;
use crate::kernel::attributes::layers::AttributeLayers;
use crate::kernel::attributes::scratch::Scratch;
use crate::kernel::attributes::seam_sectors::SeamSectors;
use crate::kernel::metric::Metric;

/// All wedges of a surface.
pub(crate) struct WedgeQuadrics<'m, M, const K: usize> {
    /// The metric of the geometry, which weighs faces for attributes too.
    pub(crate) metric: PhantomData<M>,
    /// By slot.
    pub(crate) quadrics: Vec<AttributeQuadric<K>>,
    /// By slot: the one that it has become part of; itself if it has new values, `NOBODY` if it has
    /// those of the input.
    pub(crate) merged_into: Vec<u32>,
    pub(crate) seams: SeamSectors,
    /// By slot: the chart that it is of, see [`WedgeQuadrics::chart`]; empty where each is its own.
    pub(crate) charts: Vec<u32>,
    pub(crate) layers: AttributeLayers<'m>,
    pub(crate) corners: Corners<'m>,
    pub(crate) scratch: Box<Scratch<K>>,
    /// The values that contractions gave, where that is wanted.
    pub(crate) record: Vec<RecordedValues>,
    /// How many contractions have been logged.
    pub(crate) logged: usize,
    /// What is at no wedge.
    pub(crate) none: AttributeQuadric<K>,
}

impl<M: Metric, const K: usize> WedgeQuadrics<'_, M, K> {
    #[inline(always)]
    pub(crate) fn quadric(&self, slot: u32) -> &AttributeQuadric<K> {
        self.quadrics.get(slot as usize).unwrap_or(&self.none)
    }

    /// What the slots of one vertex have in common that differ in normals and tangents alone: their
    /// place in the textures. A cut between charts stays; a crease in the shading is no obstacle.
    #[inline]
    pub(crate) fn chart(&self, slot: u32) -> u32 {
        self.charts.get(slot as usize).copied().unwrap_or(slot)
    }
}
