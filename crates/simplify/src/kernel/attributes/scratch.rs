//! Working memory for one contraction, allocated once.

use crate::kernel::attributes::attribute_quadric::AttributeQuadric;
use crate::kernel::attributes::face_wedges::FaceWedges;
use crate::kernel::collapse::edge_ring::ROOM;

/// Values at corners of spokes: one row per channel, with room for the lanes beyond the end.
type Rows<const K: usize> = [[f32; ROOM]; K];

/// Working memory for the attributes of one contraction.
pub(crate) struct Scratch<const K: usize> {
    /// Values at `ids[i]` of spoke i.
    pub(crate) first: Rows<K>,
    /// Values at `ids[i + 1]` of spoke i, at seams only; then those at its apex before and after.
    pub(crate) second: Rows<K>,
    pub(crate) before: Rows<K>,
    pub(crate) after: Rows<K>,
    /// Change of each spoke's quadric.
    pub(crate) changes: [AttributeQuadric<K>; ROOM],
    /// New quadric of each spoke, at seams only.
    pub(crate) new: [AttributeQuadric<K>; ROOM],
    /// Values of the new vertex, away from seams.
    pub(crate) values: [f32; K],
    /// Slots with new values, at seams only.
    pub(crate) renewed: Vec<NewValues<K>>,
    pub(crate) slots: FaceWedges,
    /// Values outside the channels, taken over by slots.
    pub(crate) uncosted: Vec<f32>,
    /// Slots that take them over, with the slots merged into them.
    pub(crate) taken: Vec<[u32; 2]>,
}

impl<const K: usize> Scratch<K> {
    pub(crate) fn new() -> Box<Self> {
        let (rows, quadrics) = ([[0.0; ROOM]; K], [AttributeQuadric::EMPTY; ROOM]);
        let (first, second, before, after) = (rows, rows, rows, rows);
        let (values, renewed, slots) = ([0.0; K], Vec::new(), FaceWedges::default());
        Box::new(Self {
            first,
            second,
            before,
            after,
            changes: quadrics,
            new: quadrics,
            values,
            renewed,
            slots,
            uncosted: Vec::new(),
            taken: Vec::new(),
        })
    }
}

/// A slot and its new values.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NewValues<const K: usize> {
    pub(crate) slot: u32,
    pub(crate) values: [f32; K],
    /// Slot whose chart this one joins.
    pub(crate) leader: u32,
    /// Weight in the mean of its chart's places in uv.
    pub(crate) weight: f32,
}
