//! Attributes of the kernel: a quadric at each wedge, beside the vertices.
//!
//! A wedge is known by its slot. The first wedge of a vertex has the vertex's own id as its slot,
//! the others follow after the last vertex. So a mesh without seams needs no lookup.
//!
//! Seams are contracted along themselves, both sides at once. A vertex off the seam is contracted
//! into one on it, which stays where it is. The ends of seams and the points where several meet
//! stay too.

use std::marker::PhantomData;

use crate::kernel::attributes::RecordedValues;
use crate::kernel::attributes::attribute_quadric::AttributeQuadric;
use crate::kernel::attributes::corners::Corners;
use crate::kernel::attributes::layers::AttributeLayers;
use crate::kernel::attributes::scratch::Scratch;
use crate::kernel::attributes::seam_sectors::SeamSectors;
use crate::kernel::attributes::slots::Slots;
use crate::kernel::attributes::uncosted_values::CarriedLayers;
use crate::kernel::mesh::one_ring::{GHOST, Vertices};
use crate::kernel::metric::Metric;

/// Quadrics of the wedges of a part of the surface.
pub(crate) struct WedgeQuadrics<'p, M, const K: usize> {
    /// Metric of the geometry, which also weights faces for attributes.
    pub(crate) metric: PhantomData<M>,
    /// Quadrics by slot.
    pub(crate) quadrics: Slots<'p, AttributeQuadric<K>>,
    /// By slot: the slot it was merged into, itself if it has new values, `NO_VERTEX` if it has
    /// those of the input.
    pub(crate) merged_into: Slots<'p, u32>,
    pub(crate) seams: SeamSectors<'p>,
    /// Whether no seam gives way.
    pub(crate) seams_hold: &'p mut bool,
    /// Chart of each slot, see [`WedgeQuadrics::chart`]; empty if each slot is its own.
    pub(crate) charts: Slots<'p, u32>,
    pub(crate) layers: &'p AttributeLayers<'p>,
    pub(crate) carried: CarriedLayers<'p>,
    pub(crate) corners: &'p Corners<'p>,
    pub(crate) scratch: &'p mut Scratch<K>,
    /// Values given by contractions, if an observer wants them.
    pub(crate) record: &'p mut Record,
    /// Quadric of a slot that does not exist, or not in this part.
    pub(crate) none: AttributeQuadric<K>,
}

/// Values given by contractions since they were last taken.
#[derive(Default)]
pub(crate) struct Record {
    pub(crate) values: Vec<RecordedValues>,
    /// Number of logged steps.
    pub(crate) steps: usize,
}

impl<M: Metric, const K: usize> WedgeQuadrics<'_, M, K> {
    #[inline(always)]
    pub(crate) fn quadric(&self, slot: u32) -> &AttributeQuadric<K> {
        self.quadrics.get(slot).unwrap_or(&self.none)
    }

    /// Returns the quadric of a vertex by the faces in its ring, of which none is at a seam.
    pub(crate) fn renewed(&self, vertices: &Vertices<'_>, v: u32) -> AttributeQuadric<K> {
        let (from, own) = (vertices.get(v).place(), self.quadric(v).values());
        let to = |w: u32| {
            let mut values = self.quadric(w).values();
            values.iter_mut().zip(own).for_each(|(value, own)| *value -= own);
            (vertices.get(w).place() - from, values)
        };
        let mut quadric = AttributeQuadric::of_values(own);
        let ring = vertices.neighbours(v);
        for (&a, &b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            if a != GHOST && b != GHOST {
                let ((a, to_a), (b, to_b)) = (to(a), to(b));
                quadric.add(&AttributeQuadric::face::<M>(a, b, to_a, to_b));
            }
        }
        quadric
    }

    /// Returns the chart of a slot. Slots of one vertex that differ in normals and tangents only
    /// share a chart and a place in uv. A cut between charts is kept, a crease in the shading is no
    /// obstacle.
    #[inline]
    pub(crate) fn chart(&self, slot: u32) -> u32 {
        self.charts.get(slot).copied().unwrap_or(slot)
    }
}
